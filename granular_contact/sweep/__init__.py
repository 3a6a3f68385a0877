"""Many runs of one config: Sweep -> rows, on all cores, and their table.

worker    one case, or a few, in a process of their own: tasks in, rows out
pool      processes to work in
runner    which case goes where, and what happens when one takes its process down
table     rows -> table.csv and sweep.yaml
"""

from granular_contact.sweep.pool import local_processes
from granular_contact.sweep.runner import run
from granular_contact.sweep.worker import Row

__all__ = ["Row", "local_processes", "run"]
