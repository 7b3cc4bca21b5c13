# SPDX-License-Identifier: BSD-3-Clause
"""REPORT.md from the rows of report.json."""

INTRODUCTION = """# Speed against error

Written by `./run report`; every number below was measured by that one run, on the machine named here, which others may have
been using at the same time. Times are wall times of one process on one thread. What is compared ran in turns, and the median
counts: compare times within a table, not with other machines. Errors are in parts of the true value (1 % = 0.01 in
`report.json`); those that do not involve a time are the same in every run."""

# The section with a picture in rviz.
PICTURED = "cell_counts"

# Section -> title, what was measured and how, columns (key, heading, format), what it does not show.
SECTIONS = {
    "formulations": (
        "Formulations",
        """Every way to make a cell's matrices, on five kinds of cells. *Patch*: a linear field at the boundary of the unit cube
must be taken on inside; largest deviation. *L2* and *energy*: errors against the manufactured solution
u = a sin(pi x) sin(pi y) sin(pi z) in these norms. *Tip*: deflection of a clamped beam of 1 x 0.2 x 0.2 m under its weight
against fourth- and higher-order elements, negative where too stiff. *Matrices*: time to make one cell's matrices, mean over
the beam's cells; it is paid once for each new cell. *Step*: one dynamic step of the beam, corotated, lumped mass, with a new
factorisation. Sliced meshes are cut by random planes of fixed seed and glued again, so that they keep sound cells and slivers
alike.""",
        [("mesh", "cells are", "s"), ("formulation", "formulation", "s"), ("cube_cells", "cells of the cube", "d"),
         ("patch_error", "patch", "e"), ("l2_error", "L2 [%]", "%"), ("energy_error", "energy [%]", "%"),
         ("beam_unknowns", "unknowns of the beam", "d"), ("tip_error", "tip, nu 0.3 [%]", "%"),
         ("tip_error_poisson_049", "tip, nu 0.49 [%]", "%"), ("matrix_us_per_cell", "matrices [µs a cell]", "g"),
         ("step_ms", "step [ms]", "g")],
        """Small strains and one material; two shapes of body. A tip error that changes its sign between two sizes is small by
luck near there. The uncorrected quadrature is there for comparison only. A
smaller error on one kind of cells at equal *cells* is not one at equal *unknowns*: Voronoi cells have several times more
vertices than hexahedra."""),
    "cutting": (
        "Cut bodies: polyhedra against tetrahedra",
        """The same cut body as it is, and re-tessellated into tetrahedra by our own baseline: *fewest* divides faces by
diagonals chosen for the best worst triangle, so that neighbours agree, and cones each cell from one of its own vertices, or
from a new vertex where all of those are bad; *with middles* puts a vertex in each face and each cell that is no tetrahedron.
*Block*: 27 hexahedra under three planes. *Ball*: tetrahedra under twisted, bowed sweeps of fixed seed. *Bunny*: the same
kind of cuts. Pieces that the foot does not hold are held whole. *Sag*: mean displacement along gravity, which acts sideways,
small strain, against the reference in the last column. *Condition*: largest over smallest eigenvalue of the stiffness without
fixed vertices (Lanczos; inverse by Cholesky). *Stable step*: 2 / sqrt(largest eigenvalue of M^-1 K), the longest step of an
explicit scheme, with lumped mass as it is and with the simulation's mass floor (2 % of the median vertex mass before any
cut), applied to all alike. *Step*: one implicit corotated step.""",
        [("body", "body", "s"), ("method", "as", "s"), ("cuts", "cuts", "d"), ("cells_before", "cells before", "d"),
         ("cells", "cells", "d"), ("unknowns", "unknowns", "d"), ("sag_error", "sag error [%]", "%"),
         ("condition", "condition", "e"), ("stable_step_s", "stable step [ms]", "m"),
         ("stable_step_with_mass_floor_s", "with mass floor [ms]", "m"), ("step_ms", "step [ms]", "g"),
         ("cutting_ms_per_cut", "a cut [ms]", "g"), ("retessellation_ms", "re-tessellation [ms]", "g"),
         ("loose_pieces", "loose pieces", "d"), ("cells_left_whole", "left whole", "d"), ("reference", "reference", "s"),
         ("note", "note", "s")],
        """The baseline is ours: a cutter that also moves vertices or improves its tetrahedra would make better ones, at a
price that is not in these times. Where the reference is the tetrahedra themselves, finer, it errs on the stiff side, and so
errors are a little larger than they look. The re-tessellation is of the whole cut body at once, not cut by cut."""),
    "cell_counts": (
        "How many cells cuts leave",
        """A ball and a bunny of some 8,300 tetrahedra under 17 curved cuts. *Bowed*: the sweeps of the section before. *Bent like
hairpins*: one blade of two or three bowed legs side by side, joined outside of the body, that turns and wanders as it passes the
whole body, along three directions in turns; their legs were chosen such that 17 cuts leave 40,000 to 44,000 cells (a quick run
makes fewer cuts). *Times*: tetrahedra of the baseline of the section before over our cells. Then the cells by their number of
vertices; those count too that hang in an edge or a face because a neighbour was cut.""",
        [("body", "body", "s"), ("blades", "blades", "s"), ("cuts", "cuts", "d"), ("cells_before", "cells before", "d"),
         ("cells", "cells", "d"), ("part_of_tetrahedra", "tetrahedra [%]", "%"),
         ("tetrahedra_fewest", "re-tessellated, fewest", "g"), ("times_fewest", "times", "g"),
         ("tetrahedra_with_middles", "with middles", "g"), ("times_with_middles", "times", "g")] +
        [(f"cells_of_{n}_vertices", f"{n} vertices", "d") for n in range(4, 13)] +
        [("cells_of_more_vertices", "more", "d"), ("pieces", "pieces", "d"), ("cells_left_whole", "left whole", "d"),
         ("cutting_ms_per_cut", "a cut [ms]", "g"), ("volume_error", "volume", "e"), ("mesh_violations", "faults of the mesh", "d")],
        """The baseline is ours, and of the whole cut body at once, not cut by cut. How many times fewer cells there are depends
on its rule: the fewest tetrahedra that we found, or a vertex in each face and cell. Other cuts give other counts."""),
    "integration": (
        "Time step",
        """A soft bar of 0.2 x 0.05 x 0.05 m (E = 30 kPa, hexahedra), held at one end and let go level, without damping but
that of implicit Euler. *Error*: distance of all vertices after 1 s from those of a much finer motion, extrapolated from two
step lengths, over its displacement. *Time*: of one simulated second. *Direct* factors in every step, *auto* is what a scene
gets by default; their residuals differ, and the error is all but that of the time step.""",
        [("time_step_s", "h [ms]", "m"), ("solver", "solver", "s"), ("relative_residual", "residual", "e"),
         ("error_after_1_s", "error after 1 s [%]", "%"), ("wall_ms_per_simulated_s", "time of 1 s [ms]", "g"),
         ("step_ms", "step [ms]", "g")],
        """One body and one motion, undamped, which is the hardest on a damping scheme; tissue with its own damping, or near
rest, errs less. Implicit Euler is of first order: half the error costs twice the time."""),
    "stages": (
        "What a scene pays for",
        """The same block of hexahedra with one part more from row to row; all scenes step in turns. A ball presses and slides
from *contact* on, a blade is drawn through from *cutting* on, stress is recovered in every step in *stress*. Times are means
over all steps but the first, by the simulation's own stage timer; a stage of a part that is not built takes exactly zero,
which is held. *Rest* holds stress recovery and bookkeeping.""",
        [("scene", "scene", "s"), ("cells", "cells at the end", "d"), ("assembly_ms", "assembly [ms]", "g"),
         ("solve_ms", "solution", "g"), ("detection_ms", "detection", "g"), ("contact_ms", "contact", "g"),
         ("cutting_ms", "cutting", "g"), ("update_ms", "update", "g"), ("other_ms", "rest", "g"),
         ("total_ms", "sum", "g"), ("largest_total_ms", "largest step", "g"), ("contacts_per_step", "contacts a step", "g")],
        """Contact of the tissue with itself is not part of the product yet, so it is not here. A linear scene keeps its one
factor; with rotations each step iterates, and after a cut by another preconditioner (see Solvers). A longer cut has more steps with an update."""),
    "peers": (
        "A peer in the same run: Bullet",
        """Bullet's deformable bodies (btDeformableMultiBodyDynamicsWorld with btDeformableLinearElasticityForce, corotated
linear elasticity) beside our tetrahedra: the same mesh, material (nu = 0.45), lumped masses, gravity and clamped end, in
turns. Both solve the same equations. Bullet's implicit step is on, its damping, drag, sleeping, stress limit and collisions
are off; contact by projection. Debian's ordinary build, in single precision, was about twice as fast as the one in double
precision at the same error. *Motion error*: distance of all vertices at every sixtieth of a second from a motion extrapolated
from much finer steps, over the displacements. *Sag error*: after 20 s in steps of
1/30 s, by when the scheme has damped the swing away, against the minimum of the energy.""",
        [("body", "body", "s"), ("peer", "who", "s"), ("settings", "settings", "s"), ("time_step_s", "h [ms]", "m"),
         ("motion_error", "motion error [%]", "%"), ("sag_error", "sag error [%]", "%"), ("step_ms", "step [ms]", "g"),
         ("wall_ms_per_simulated_s", "time of 1 s [ms]", "g"), ("wall_ms_to_sag", "time to the sag [ms]", "g")],
        """Bullet is made for games and robots with contact and offers no direct solver: this is its way to solve, tuned as
well as we could, on tetrahedra without contact and without cuts. Single precision is part of its speed and of its error.
The reference motion comes from our program; that Bullet comes near it with finer steps is the check on that."""),
    "solvers": (
        "Solvers",
        """Whole steps (assembly, solution, update) of 1/60 s from rest by every solver of ours and by Bullet, in turns: E = 100 kPa,
nu = 0.45, 1000 kg/m^3, gravity along -y, consistent mass, no damping, one solve a step. *bunny8k* and *beam10k*: the Stanford bunny and a
clamped beam whose displacements two other programs agree on (they are measured where POLYSCALPEL_TEST_MESHES names their folder); the others
are of our generator, compared with our own direct solver, whose residual is below 1e-10. *Error*: the largest relative one of the largest
displacement after 5, 10 and 60 steps. *Step*: median of steps 2 to 60, on one thread the thread's own work, on more wall time; *first*: the step that
makes factor or groups. *Memory*: what assembly, solver and state hold after the last step. *jacobi*
ends at a residual of 1e-5, the others at 1e-4; where 500 iterations are not enough, double precision is tried and then a direct factor, which
*fallbacks* counts. *Bullet*: lumped mass, single precision, one Newton iteration of at most 300 conjugate gradients to 1e-6 of
its own measure.""",
        [("body", "body", "s"), ("cells", "cells", "d"), ("unknowns", "unknowns", "d"), ("solver", "solver", "s"),
         ("threads", "threads", "d"), ("solved_by", "solved by", "s"), ("step_ms", "step [ms]", "g"), ("assembly_ms", "assembly", "g"),
         ("solve_ms", "solution", "g"), ("first_ms", "first", "g"), ("iterations", "iterations", "g"),
         ("fallbacks", "fallbacks", "d"), ("gate_error", "error", "e"), ("residual", "residual", "e"),
         ("memory_mb", "memory [MB]", "g"), ("note", "note", "s")],
        """One material and one length of step; contact and sleeping pieces are not here. Assembly and solution are wall times, so that their sum
may be more than the step where others use the machine. Two threads wait for each other longest where a third wants a core."""),
    "scaling": (
        "How a step grows with the body",
        """The same steps of beams and balls of our generator, of one shape each and ever more tetrahedra. *Exponent*: slope of log time
against log cells from 40,000 cells on, auto, least squares; 1.15 at most is the goal. Bodies above 50,000 cells make 10 steps and are not
compared with a direct factor.""",
        [("body", "body", "s"), ("solver", "solver", "s"), ("solved_by", "solved by", "s"), ("cells", "cells", "d"),
         ("unknowns", "unknowns", "d"), ("step_ms", "step [ms]", "g"), ("us_per_unknown", "[µs an unknown]", "g"),
         ("iterations", "iterations", "g"), ("first_ms", "first [ms]", "g"), ("memory_mb", "memory [MB]", "g"),
         ("gate_error", "error", "e"), ("exponent", "exponent", "g")],
        """The bodies keep their size and the step its length, so that finer ones are harder in two ways: more unknowns, and more of them
between one end and the other."""),
    "after_cuts": (
        "Steps after many cuts",
        """The ball of the cell counts after 17 cuts bent like hairpins, as polyhedra and re-tessellated by the baseline of that section
(*fewest*), by the same stepper (auto) and by one that factors in every step (direct), in turns: steps of 1/60 s, E = 10 kPa, nu = 0.3, lumped
mass, no damping, to a relative residual of 1e-5: slivers fill the residual, and at the default of 1e-4 errors were 2e-4. *Times*: over
polyhedra on one thread. *Error*: of the largest displacement after 5 and 10 steps, against the direct
solver on the same mesh.""",
        [("body", "body", "s"), ("method", "as", "s"), ("solver", "solver", "s"), ("threads", "threads", "d"), ("cuts", "cuts", "d"),
         ("cells_before", "cells before", "d"), ("cells", "cells", "d"), ("times_cells", "times", "g"), ("unknowns", "unknowns", "d"),
         ("times_unknowns", "times", "g"), ("step_ms", "step [ms]", "g"), ("steps_per_s", "steps a second", "g"),
         ("times_step", "times", "g"), ("iterations", "iterations", "g"), ("fallbacks", "fallbacks", "d"),
         ("first_ms", "first [ms]", "g"), ("gate_error", "error", "e"), ("memory_mb", "memory [MB]", "g")],
        """Pieces that the foot does not hold are held whole: their cells count, their vertices are no unknowns, and a step passes them
over. In the rows below they fall, so that all but the foot moves; there auto leaves its aggregates for a factor after two steps, and
*step* is the median over all but the first. The solver meets the cut body as it is; what it costs to follow a cut is in `./run bench`."""),
    "limits": (
        "How far from the limit",
        """The stages of a step, each by itself on a twisted body, one thread, beside the time in which their data could come by
at all. *linearise*: each cell's rotation, forces, and what the matrix is made from. *assemble*: the matrix in single precision.
*product* and *factor* or *aggregates*: the matrix by a vector, and one application of the preconditioner; an iteration is one of
each. *Least*: what the stage is given and hands on, each array once at its own size, a factor's numbers twice, down and up.
*Bandwidth*: reading an array as large as what the stage has to hold, again and again in the same turns, so from the cache that it
fits. *Bound*: least over that; *times*: time over bound. *From memory*: the same bound by the triad of the last row, whose arrays
no cache holds. Times are the thread's own, medians of runs that find in the caches what the run before has left. *Instructions* (of
each cell, block or unknown) and *fetched* (lines of 64 bytes that a core's own 32 KB and 512 KB of cache miss; *part*: over the
least): as callgrind counts one run. It knows one rounding mode and exact predicates ask for others, so bodies that were cut are left
out. *Kernels*: the registers that the fastest of them are compiled for.""",
        [("body", "body", "s"), ("stage", "stage", "s"), ("items", "of", "d"), ("item", "each a", "s"),
         ("least_mb", "least [MB]", "g"), ("held_mb", "to hold [MB]", "g"), ("bandwidth_gb_s", "bandwidth [GB/s]", "g"),
         ("bound_ms", "bound [ms]", "g"), ("time_ms", "time [ms]", "g"), ("ratio", "times", "g"),
         ("memory_bound_ms", "from memory [ms]", "g"), ("instructions_each", "instructions each", "g"),
         ("instructions_per_ns", "a ns", "g"), ("fetched_mb", "fetched [MB]", "g"), ("fetched_part", "part", "g"),
         ("registers", "kernels", "s"), ("note", "note", "s")],
        """How far arithmetic alone is from its own limit: instructions a nanosecond tell how busy the core is, not whether fewer
would do. In a step a stage finds in the caches what the stages before it have left, not its own data. Lines that are written
whole count as fetched too, and what a core writes back does not."""),
    "hard_cases": (
        "Hard cases",
        """One row a case: what happens, and where it stops holding. A case *holds* where its value stays at or below its
bound; where *we lose*, the row says what happens instead. `./run test` holds a short form of each row.""",
        [("case", "case", "s"), ("what_happens", "what happens", "s"), ("limit", "where it stops holding", "s"),
         ("quantity", "value is", "s"), ("value", "value", "g"), ("bound", "bound", "g"), ("outcome", "outcome", "s")],
        "Cases that nobody has thought of."),
    "hard_solvers": (
        "Hard motions by every solver",
        """Whole motions that are hard on what solves a step's system, by every solver of ours, each by itself: no damping, steps of 1/60 s
where none are named. *Twist*: one end of a bar of hexahedra is turned twice, 6 degrees before each step of 0.05 s. *Steps of 0.1 s* and *1e9 Pa*: a
beam of tetrahedra let go level, which the scheme brings to rest. *nu*: a beam of hexahedra that swings. *Thrown*: every vertex
of a soft block of 5,000 tetrahedra, but for those of one side, is put anywhere in the block, so that half of the cells are inverted, and let go.
*Slivers*: a beam after random cuts of every kind, each piece hung by its largest cell, no mass floor. *Iterations*: of conjugate gradients, the mean
of all steps and the most in one; where 500 are not enough, or break down, double precision is tried, and then a direct factor: *fallbacks*
counts both, and *half steps* the parts of steps that had to be divided. *Residual*: the largest of all steps, as the solver
itself says. *Deviation*: largest distance of the whole body from where the direct solver has it after the same step, over its longest way from rest,
in the norm over all vertices. *Value*: of the end of the motion, and must be at most its *bound*. All is held but the deviation where motions part by
themselves; auto must not fall back, but where *we lose*.""",
        [("case", "case", "s"), ("solver", "solver", "s"), ("solved_by", "solved by", "s"), ("steps", "steps", "d"), ("cells", "cells", "d"),
         ("unknowns", "unknowns", "d"), ("iterations", "iterations", "g"), ("most_iterations", "most", "d"),
         ("fallbacks", "fallbacks", "d"), ("half_steps", "half steps", "d"), ("residual", "residual", "e"),
         ("inverted_at_start", "inverted at first", "d"), ("inverted_at_end", "at the end", "d"), ("deviation", "deviation", "e"),
         ("step_ms", "step [ms]", "g"), ("quantity", "value is", "s"), ("value", "value", "e"), ("bound", "bound", "g"), ("note", "note", "s")],
        """One size of each body, no contact, and no cut while it moves. Each ran once: the times are for orders of magnitude."""),
    "torture": (
        "Random torture of the cutting kernel",
        """Random cuts of fixed seed, 25 one after the other on a fresh body (10 on the bunny), so that most go over earlier
cuts; one in four through a smoothly deformed body, so that caps are bent; half of the strokes progressive, half at once. After
every cut every invariant of the mesh is checked, and the pieces are counted by a flood fill of our own. *Left whole*: cells
that a blade passed and no fallback could split soundly. *Invalid*: cuts after which an invariant did not hold. *Missing*:
parts on the two sides of a cut that passes through everything, each further from it than the snap distance, that still hang
together. *Torn*: parts of a convex body that no plane separates, and that are apart all the same; or what comes apart where a
cut is repeated. *Volume*: largest error of the whole body's volume after any cut, relative. *Shortest edge*: rest length by
the size of the uncut mesh there.""",
        [("mesh", "mesh", "s"), ("kind", "kind", "s"), ("cuts", "cuts", "d"), ("splits", "splits", "d"),
         ("left_whole", "left whole", "d"), ("left_whole_per_split", "a split", "e"), ("invalid", "invalid", "d"),
         ("pieces_missing", "missing", "d"), ("pieces_torn", "torn", "d"), ("volume_error", "volume", "e"),
         ("shortest_edge", "shortest edge [h]", "e")],
        """Strokes that stop inside, cross themselves or touch a corner have no known number of pieces: there only the mesh is
checked. Parts thinner than the snap distance may hang on to their neighbours by design."""),
}

# What is held in sections each of whose rows has a bound of its own, which the table shows.
RULES = {"hard_cases": "value at most its bound, or as the row says",
         "hard_solvers": "all finite; value at most its bound; residual of direct <= 1e-10; deviation of the others <= 0.001, <= 0.01 "
                         "where we lose, any where motions part by themselves; fallbacks of auto = 0 but where we lose"}


def _number(value):
    if value == 0:
        return "0"
    if abs(value) >= 1000:
        return f"{value:,.0f}"
    return f"{value:.3g}" if abs(value) >= 1e-3 else f"{value:.1e}"


def _cell(row, key, form):
    value = row.get(key)
    if value is None:
        return ""
    if form == "s" or isinstance(value, (str, bool)):
        return str(value).replace("|", "/")
    if form == "d":
        return f"{value:,}"
    if form == "e":
        return f"{value:.1e}"
    return _number({"%": 100, "m": 1000}.get(form, 1) * value)


def _columns_of(rows):
    keys = list(dict.fromkeys(key for row in rows for key in row if key not in ("held", "holds")))
    return [(key, key.replace("_", " "), "g") for key in keys]


def _table(rows, columns):
    columns = [column for column in columns if any(column[0] in row for row in rows)]
    lines = ["| " + " | ".join(heading for _, heading, _ in columns) + " |", "|" + "---|" * len(columns)]
    lines += ["| " + " | ".join(_cell(row, key, form) for key, _, form in columns) + " |" for row in rows]
    return "\n".join(lines)


def _rules(section, rows):
    if section in RULES:
        kept = sum(row.get("holds", True) for row in rows)
        return [f"| {section} | {RULES[section]} | {kept} of {len(rows)} "
                f"{'' if kept == len(rows) else '**broken**'} |"]
    lines = []
    for rule in dict.fromkeys(row["held"] for row in rows if "held" in row):
        of_rule = [row for row in rows if row.get("held") == rule]
        kept = sum(row["holds"] for row in of_rule)
        lines.append(f"| {section} | {rule} | {kept} of {len(of_rule)} {'' if kept == len(of_rule) else '**broken**'} |")
    return lines


def _picture(picture):
    if "file" in picture:
        return [f"![{picture['shows']}]({picture['file']})", "", f"In rviz: {picture['shows']}."]
    return [picture.get("missing", "no picture in rviz was taken").capitalize() + "."]


def write(report, plots, date):
    """The whole page. plots: names of the sections that have one; date: of the run."""
    machine = report["machine"]
    memory = machine["memory"]
    if memory.endswith(" kB"):
        memory = f"{int(memory.split()[0]) / 1e6:.0f} GB"
    parts = [INTRODUCTION, "", "| | |", "|---|---|",
             f"| machine | {machine['cpu']}, {machine['cores']} cores, {memory}, {machine['os']} |",
             f"| compiler | {machine['compiler']}, {machine['flags']} |",
             f"| commit | {report['commit']} |",
             "| versions | " + ", ".join(f"{name} {version}" for name, version in report["versions"].items()) + " |",
             f"| run | {date}, {report['mode']}, {report['duration_s'] / 60:.1f} minutes |"]
    rules = []
    for section, (title, how, columns, limits) in SECTIONS.items():
        rows = report[section]
        if not rows:
            continue
        rules += _rules(section, rows)
        parts += ["", f"## {title}", "", how, ""]
        if section in plots:
            parts += [f"![{title}]({section}.png)", ""]
        if section == PICTURED:
            parts += _picture(report.get("picture", {})) + [""]
        parts += [_table(rows, columns or _columns_of(rows)), "", "**What it does not show.** " + limits]
    parts += ["", "## What is held", "",
              "Values that must hold, or the report fails; counted over the rows that they are about.", "",
              "| section | rule | holds in |", "|---|---|---|"] + rules
    return "\n".join(parts) + "\n"
