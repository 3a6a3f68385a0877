"""Many runs of one config: Sweep -> rows, on all cores or a cluster, and their table.

worker       one case, or a few, in a process of their own: tasks in, rows out
journal      rows on the disk as they come
cluster      workers of a Dask cluster
executor     the pool of either kind of worker, made when needed
runner       which case goes where, and what happens when one kills its process
checkpoint   the folder from which a killed sweep goes on
calls        a sweep from Python
table        rows -> table.csv, and sweep.yaml
sensitivity  rows -> Sobol indices
slip         rows of a wheel -> its forces against slip
"""

from granular_contact.errors import WorkerPoolError
from granular_contact.studies.processes import local_processes
from granular_contact.studies.sweep.checkpoint import FolderRefused
from granular_contact.studies.sweep.executor import WorkerPool
from granular_contact.studies.sweep.journal import Journal, Row
from granular_contact.studies.sweep.runner import run

__all__ = ["FolderRefused", "Journal", "Row", "WorkerPool", "WorkerPoolError", "local_processes", "run"]
