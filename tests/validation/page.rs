//! The page that shows model, thesis and experiment side by side.
use crate::reference::{Prototype, Reference, mean};
use crate::{JAWS, QUANTITIES, Run};
use std::fmt::Write;

/// Printed values of [Zilka2022] tables 7 and 8: E, maximum force, strain there, Poisson ratio.
const THESIS: [(&str, [[f64; 4]; 3]); 2] = [
    (
        "sequential (table 7)",
        [
            [28.27, 136.32, 1.15, 0.33],
            [28.43, 137.65, 1.14, 0.32],
            [27.49, 145.15, 1.16, 0.31],
        ],
    ),
    (
        "parallel (table 8)",
        [
            [28.57, 140.08, 1.135, 0.24],
            [28.85, 137.17, 1.19, 0.26],
            [28.7, 130.11, 1.105, 0.26],
        ],
    ),
];
/// Layers of the fabric.
const LAYERS: f64 = 3.0;
/// [Zilka2022] table 4, measured across the machine direction.
const EXPERIMENT: [(&str, f64); 3] = [
    ("max_force", 388.2),
    ("strain_at_max_force", 1.183),
    ("poisson_ratio", 0.6),
];

/// One test's row of the page.
pub(crate) fn row(run: &Run) -> String {
    let [force, strain, poisson, stiffness] = run.values;
    format!(
        "| {} | {} | {force:.1} | {strain:.2} | {poisson:.3} | {stiffness:.2} |",
        run.jaws, run.seed
    )
}

/// The whole page.
pub(crate) fn write(runs: &[Run]) -> String {
    let seeds = runs.len() / JAWS.len();
    let mut page = format!(
        "# Nonwoven tensile test: model, thesis and experiment\n\n\
        Needle-punched PET, 49 x 51 x 3 lattice, the example `nonwoven_tensile` (parameters: [Zilka2022] \
        tables 5 and 6), solver `newton_cg`, force accuracy 1e4, {seeds} seeds. Written by\n\
        `LOADFRAME_VALIDATION=write cargo test --release -p loadframe-tests --test validation`.\n\n\
        ## Against the experiment ([Zilka2022] table 4)\n\n\
        | quantity | measured | half-bond jaws | off | clamped rows | off |\n|---|---|---|---|---|---|\n"
    );
    for (name, measured) in EXPERIMENT {
        write!(page, "| {} | {measured} |", name.replace('_', " ")).unwrap();
        for jaws in JAWS {
            let found = mean(runs, jaws, name);
            let off = 100.0 * (found / measured - 1.0);
            let digits = if name == "max_force" { 1 } else { 3 };
            write!(page, " {found:.digits$} | {off:+.0} % |").unwrap();
        }
        page.push('\n');
    }
    page.push_str(
        "\nThe measured modulus (68.86 MPa) cannot be compared: thickness and grammage are not given. \
        The parameters were fitted to this very fabric by the thesis' source, so that agreement is \
        a check of the calculation more than of the model.\n\n\
        ## Against the thesis' simulations ([Zilka2022] tables 7 and 8)\n\n\
        The thesis' forces and moduli fit this model divided by its three layers, which suggests that \
        one layer was counted at each jaw point; this is inferred, not read from its program. E is the \
        secant stiffness at 10 %, in N over strain.\n\n\
        | source | E per layer | F max per layer [N] | strain there | Poisson ratio |\n|---|---|---|---|---|\n",
    );
    for (name, values) in THESIS {
        let [stiffness, force, strain, poisson] =
            [0, 1, 2, 3].map(|column| values.iter().map(|row| row[column]).sum::<f64>() / 3.0);
        writeln!(page, "| thesis, {name}, mean of 3 | {stiffness:.2} | {force:.1} | {strain:.3} | {poisson:.2} |").unwrap();
    }
    for jaws in JAWS {
        let [force, strain, poisson, stiffness] = QUANTITIES.map(|name| mean(runs, jaws, name));
        writeln!(
            page,
            "| loadframe, {jaws}, mean of {seeds} | {:.2} | {:.1} | {strain:.3} | {poisson:.3} |",
            stiffness / LAYERS,
            force / LAYERS
        )
        .unwrap();
    }
    page.push_str(
        "\nThe thesis' Poisson ratios (0.24 to 0.33) are those of relaxations that stop too early: the \
        error left sits in long waves whose resultants are tiny.\n\n\
        ## Against a second program\n\n\
        `tests/validation/prototype.py` solves the same model with a lattice, random streams and a solver \
        of its own (numpy, scipy), so that only distributions can be compared; the test holds the means \
        against each other within what seeds scatter.\n\n\
        | jaws | quantity | loadframe, mean | prototype, mean ± standard deviation | its seeds |\n|---|---|---|---|---|\n",
    );
    for reference in &Prototype::read().results {
        let Reference { jaws, quantity, .. } = reference;
        let found = mean(runs, jaws, quantity);
        let digits = match quantity.as_str() {
            "max_force" => 1,
            "secant_stiffness_at_10_percent" => 2,
            _ => 3,
        };
        writeln!(
            page,
            "| {jaws} | {} | {found:.digits$} | {:.digits$} ± {:.digits$} | {} |",
            quantity.replace('_', " "),
            reference.mean,
            reference.deviation,
            reference.n
        )
        .unwrap();
    }
    page.push_str(
        "\n## Each seed\n\n\
        | jaws | seed | F max [N] | strain there | Poisson ratio | stiffness at 10 % [N] |\n|---|---|---|---|---|---|\n",
    );
    for run in runs {
        page.push_str(&row(run));
        page.push('\n');
    }
    page.push_str(
        "\n[Zilka2022]: M. Žilka, Simulace mechanické odezvy netkané textilie (bachelor thesis), \
        Technical University of Liberec, 2022.\n",
    );
    page
}
