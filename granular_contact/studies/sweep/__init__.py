"""Many runs of one config: Sweep -> rows, on all cores or a cluster, and their table.

worker       one case, or a few, in a process of their own: tasks in, rows out
journal      rows on the disk as they come
pool         processes of this machine to work in
cluster      those of a Dask cluster
crew         either of them, renewed when broken
runner       which case goes where, and what happens when one takes its process down
part         the folder that a sweep goes on in after it was killed
table        rows -> table.csv, and sweep.yaml
sensitivity  rows -> Sobol indices
"""

from granular_contact.studies.sweep.crew import Crew, CrewError
from granular_contact.studies.sweep.journal import Journal, Row
from granular_contact.studies.sweep.part import FolderRefused
from granular_contact.studies.sweep.pool import local_processes
from granular_contact.studies.sweep.runner import run

__all__ = ["Crew", "CrewError", "FolderRefused", "Journal", "Row", "local_processes", "run"]
