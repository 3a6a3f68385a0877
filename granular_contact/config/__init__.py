"""First stage of a run: YAML to a `Scenario`, strict and frozen, with every fault at its line. Imports nothing heavy.

reading    yaml_source, tree                    text to a tree with positions
           file_kind                            run, sweep, optimisation or fit; in the plane or in space
resolving  references, overrides, given         names, `from`, provenance; `--set` and values from Python; to one tree
           urdf, urdf_corrections               robot files, and the keys that replace their values
           columns, csv_table                   CSV files that a config names
checking   schema, load, template               one tree to a Scenario
           allowed, messages, structure_errors  or to faults in sentences
changing   changed, differences, add_law        changes from Python, differences of scenarios, laws of users
writing    export                               plain data, JSON Schema
           written_numbers                      numbers into the files that contain their keys
many runs  sweep, sweep_cases                   a config and values that cases replace
           optimise                             a config, its parameters and an objective
"""

from granular_contact.config import schema
from granular_contact.config.export import json_schema, scenario_to_dict
from granular_contact.config.file_kind import is_fit, is_optimise, is_run, is_sweep
from granular_contact.config.load import Given, load, load_medium, load_scenario, loaded, scenario_given
from granular_contact.config.optimise import Study, load_optimise
from granular_contact.config.references import medium_names
from granular_contact.config.schema import Scenario
from granular_contact.config.sweep import Sweep, load_sweep
from granular_contact.config.sweep_cases import Case
from granular_contact.config.template import Loaded, SourceMap
from granular_contact.config.written_numbers import write_numbers

__all__ = [
    "Case",
    "Given",
    "Loaded",
    "Scenario",
    "SourceMap",
    "Study",
    "Sweep",
    "is_fit",
    "is_optimise",
    "is_run",
    "is_sweep",
    "json_schema",
    "load",
    "load_medium",
    "load_optimise",
    "load_scenario",
    "load_sweep",
    "loaded",
    "medium_names",
    "scenario_given",
    "scenario_to_dict",
    "schema",
    "write_numbers",
]
