"""The outcome of a run in words. That of a logged run is the simulator's where its record lies beside the log."""
import numpy as np

import plots
import runs
import watch
import wire

MOST_FAULTS = 5  # that are named


def contact(run):
    """Of a run with the columns of the simulator's record."""
    in_contact = np.flatnonzero(run.touching())
    if not in_contact.size:
        return "no"
    first = in_contact[0]
    return f"yes, {'links ' if run.touching_itself()[first] else ''}at {run.columns['t_s'][first]:.2f} s"


def least(t_s, values_m):
    """The least finite value and when."""
    finite = np.flatnonzero(np.isfinite(values_m))
    if not finite.size:
        return "nothing to touch"
    row = finite[np.argmin(values_m[finite])]
    return f"{values_m[row]:.4f} m at {t_s[row]:.2f} s"


def at_the_end(distances_m):
    return plots.length(distances_m[-1]) if np.isfinite(distances_m[-1]) else "no target"


def faults(run):
    """Of a run with the column `fault`: which began when and lasted how long."""
    t_s, values = run.columns["t_s"], run.columns["fault"]
    changes = np.flatnonzero(np.diff(values, prepend=0, append=0) != 0)
    found = [(row, t_s[min(end, len(t_s) - 1)]) for row, end in zip(changes, changes[1:]) if values[row] != 0]
    texts = [f"{watch.FAULTS.get(values[row], 'unknown')} at {t_s[row]:.2f} s, for {end_s - t_s[row]:.2f} s"
             for row, end_s in found[:MOST_FAULTS]]
    more = [f"{len(found) - MOST_FAULTS} more"] if len(found) > MOST_FAULTS else []
    return "; ".join(texts + more) or "none"


def record_of(run, log):
    """The simulator's record of a logged run, a runs.Run with the times of the log; None without one."""
    file = runs.file_of({"name": run.name} if run.name else {}, log.with_suffix(".csv"))
    tracking = np.flatnonzero(run.columns["mode"] == wire.controller_status_t.TRACK)
    if not file.is_file() or not tracking.size:
        return None
    columns = runs.read_csv(file)
    if not columns:
        return None
    return run._replace(columns=columns | {"t_s": columns["t_s"] + run.columns["t_s"][tracking[0]]})


def measured_by(record):
    """Who measured. The times in a report are those of the log; the simulator's own begin when the arm tracks."""
    if not record:
        return "the controller, which knows only what it receives"
    return f"the simulator, whose clock starts {record.columns['t_s'][0]:.2f} s later than this page's"


def rows(run, log):
    """[(name, text)] of a logged run, logs.run_of()."""
    file, record = runs.verdict_file(log), record_of(run, log)
    known = (record or run).columns
    clearance_m = plots.clearance(record) if record else known["clearance_m"]
    touches = contact(record) if record else "yes" if (clearance_m < 0).any() else "no"
    links = ([("least distance between links", least(known["t_s"], known["self_clearance_m"]))]
             if np.isfinite(known.get("self_clearance_m", np.nan)).any() else [])
    return [("expectations of the scenario", file.read_text() if file.is_file() else "not known"),
            ("faults", faults(run)), ("contact", touches), ("least clearance", least(known["t_s"], clearance_m)),
            *links, ("distance to the target at the end", at_the_end(known["target_distance_m"])),
            ("measured by", measured_by(record))]
