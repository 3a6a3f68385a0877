"""The best numbers of a config: Study -> runs on all cores or a cluster, generation by generation -> the best of them.

search    study and worker pool -> outcome: CMA-ES or differential evolution asks
          for numbers; with a journal it goes on where it was killed
outcome   what a run is worth; the best run, and what it gains over the config as it was
writing   outcome -> history.csv, best.yaml, best/, optimise.json, figures
calls     a search from Python

A method is asked for a whole generation at a time, and given what came of it in the order in which it was asked. So
what it asks for next depends on the seed alone, not on who worked or in which order runs came to an end. A search that
was killed is begun again from its seed; runs that are in the journal are read there.
"""
