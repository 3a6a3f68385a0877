"""Run the cases of a sweep on all cores or a Dask cluster, and write their table.

worker       one or several cases in a worker process: tasks in, rows out
journal      rows on the disk, stored as soon as they are computed
cluster      workers of a Dask cluster
executor     pool of workers of either kind, created when needed
runner       distribution of cases to workers; handling of a case that kills its process
checkpoint   work folder from which an interrupted sweep continues
calls        a sweep from Python
table        table.csv and sweep.yaml
sensitivity  Sobol indices
slip         figure of the forces of a wheel against its slip
"""

from granular_contact.errors import WorkerPoolError
from granular_contact.studies.processes import local_processes
from granular_contact.studies.sweep.checkpoint import FolderRefused
from granular_contact.studies.sweep.executor import WorkerPool
from granular_contact.studies.sweep.journal import Journal, Row
from granular_contact.studies.sweep.runner import run

__all__ = ["FolderRefused", "Journal", "Row", "WorkerPool", "WorkerPoolError", "local_processes", "run"]
