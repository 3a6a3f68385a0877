"""Optimise parameters of a config: runs on all cores or a cluster, generation by generation.

search    the search by CMA-ES or differential evolution on a worker pool; with a journal it continues after a kill
outcome   objective, constraints and cost of a run; the best run, and its gain over the config as it is
writing   history.csv, best.yaml, best/, optimise.json and figures of an outcome
calls     a search from Python

The method proposes a whole generation at a time, and receives its costs in the order of the proposals. So the next
generation depends on the seed alone, not on the workers or the order in which runs end. A search that was killed starts
again from its seed and reads the runs that are already in the journal.
"""
