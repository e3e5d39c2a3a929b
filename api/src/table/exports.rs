//! Ten exports beside the usual: what their titles and footers say is read, or refused by name.
use super::{Hints, Place, Reading, Refusal, Wanted, hints::ColumnHint, read};

fn ask(text: &str, hints: Hints<'_>) -> Result<Reading, Refusal> {
    let wanted = ["nominal_strain", "force_n"].map(|name| Wanted {
        name: name.to_owned(),
    });
    read(text, &wanted, &hints)
}

/// 10 and 20 % at 0.23 and 0.52 N.
fn assert_read(text: &str) {
    let reading =
        ask(text, Hints::default()).unwrap_or_else(|refusal| panic!("{refusal:?} of {text}"));
    let expected = [[0.1, 0.23], [0.2, 0.52]];
    assert_eq!(reading.points.len(), 2, "{reading:?} from {text}");
    for (one, other) in reading
        .points
        .iter()
        .flatten()
        .zip(expected.iter().flatten())
    {
        assert!((one - other).abs() < 1e-12, "{reading:?} from {text}");
    }
}

fn assert_refused(text: &str, place: Place, named: &str) {
    match ask(text, Hints::default()) {
        Ok(reading) => panic!("{text} was read as {reading:?}"),
        Err(refusal) => assert!(
            refusal.place == place && refusal.detail.contains(named),
            "{refusal:?} of {text}"
        ),
    }
}

#[test]
fn a_title_that_says_more_than_a_name_and_a_unit_is_refused() {
    for title in [
        "Load (mN) x10",
        "Load x10 (mN)",
        "Load [mN] *1e3",
        "Load (mN) (x 1000)",
        "Force [N] (per 15 mm)",
        "Force per 15 mm [N]",
        "Force / width (N)",
        "Load (N) (% of max)",
        "log Load (N)",
        "-Load (N)",
        "Load (N) (kN)",
        "Load N x1000",
        "force_per_width_n",
    ] {
        assert_refused(
            &format!("Strain,{title}\n0.1,2\n0.2,3\n"),
            Place::Unit(1),
            title,
        );
    }
    for title in [
        "Strain x100",
        "True strain (%)",
        "wahre Dehnung",
        "Strain rate",
    ] {
        assert_refused(
            &format!("{title};Load (N)\n0,1;2\n0,2;3\n"),
            Place::Unit(0),
            title,
        );
    }
    // in the title, its unit on a line of its own, and both with another unit
    assert_refused(
        "Strain;Load x10\n%;mN\n10,0;2\n",
        Place::Unit(1),
        "Load x10",
    );
    assert_refused(
        "Strain;Load (N)\n%;kN\n10,0;2\n",
        Place::Unit(1),
        "Load (N)",
    );
    // with a column beside it that says nothing of the kind, neither is taken
    assert_refused(
        "Strain,Load (N),Load (mN) x10\n0.1,2,3\n",
        Place::Column(1),
        "'Load (mN) x10'",
    );
    // a unit that is one per width, also where the column is named
    let strip = "Strain,Force (N/15mm)\n0.1,2\n";
    assert_refused(strip, Place::Column(1), "'Force (N/15mm)'");
    let named = ColumnHint {
        column: Some("Force"),
        unit: None,
    };
    let hints = Hints {
        columns: [ColumnHint::default(), named],
        ..Hints::default()
    };
    let refusal = ask(strip, hints).expect_err("a force per width");
    assert_eq!(refusal.place, Place::Unit(1), "{refusal:?}");
    assert!(refusal.allowed.contains("times the width"), "{refusal:?}");
    // the user's word: ten millinewtons each
    let unit = ColumnHint {
        column: None,
        unit: Some("cN"),
    };
    let hints = Hints {
        columns: [ColumnHint::default(), unit],
        ..Hints::default()
    };
    let reading = ask("Strain,Load (mN) x10\n0.1,23\n", hints).expect("read");
    assert_eq!(reading.points, [[0.1, 0.23]]);
    for title in [
        "Load 1 (N)",
        "Load (Channel 2) (N)",
        "Kraft / Force (N)",
        "Standardkraft ( N )",
        "Weg (s) F [N]",
    ] {
        assert_read(&format!("Strain;{title}\n0.1;0.23\n0.2;0.52\n"));
    }
    assert_read("Strain 1 in %;Kraft F in N\n10,0;0,23\n20,0;0,52\n");
}

#[test]
fn units_above_the_names_are_theirs_or_refused() {
    assert_read("%;kN\nStrain;Load\n10;0.00023\n20;0.00052\n");
    for (line, side) in [
        ("Units;kN", 0),
        ("Force unit: kN", 0),
        ("Einheit;[kN]", 0),
        ("Fmax (kN);0.00052", 1),
    ] {
        let text = format!("{line}\nStrain;Load\n0.1;0.23\n0.2;0.52\n");
        assert_refused(&text, Place::Unit(side), "line 1");
    }
    assert_read("Preload;0.01;N\nBreak at;80;%\nStrain;Load\n0.1;0.23\n0.2;0.52\n");
}

#[test]
fn a_footer_is_no_point() {
    let table = "Time (s);Strain;Load (N)\n1;0.1;0.23\n2;0.2;0.52\n";
    for (footer, line) in [
        // a word where the points have a number
        ("Mean;0.15;0.375\n", "line 4"),
        ("\nFmax;0.2;0.52\nEmod;0.1;2.3\n", "line 5"),
        ("A;0.2;0.52\nB;0.1;2.3\n", "line 4"),
        ("3;0.15;0.375;Mean\n", "line 4"),
        // numbers alone, below an empty line
        ("\n1.5;0.15;0.375\n0.7;0.05;0.145\n", "line 5"),
        (";;\n1.5;0.15;0.375\n", "line 5"),
    ] {
        assert_refused(&format!("{table}{footer}"), Place::Text, line);
    }
    // in a table whose first column is of words, or empty
    for first in ["ok", ""] {
        let text = format!(
            "Status;Strain;Load (N)\n{first};0.1;0.23\n{first};0.2;0.52\nStd. dev.;0.05;0.145\n"
        );
        assert_refused(&text, Place::Text, "line 4");
    }
    // spaces between cells
    assert_refused(
        "Time Strain Load/N\n1 0.1 0.23\n2 0.2 0.52\n\n1 0.15 0.375\n",
        Place::Text,
        "line 5",
    );
    // events, values that are missing, a kind of data in every line, empty lines between all points
    for text in [
        "Strain;Load (N);Event\n0.1;0.23;\n0.2;0.52;break\n",
        "Strain;Load (N);Ext. (mm)\n0.1;0.23;1.0\n0.2;0.52;----\n",
        "Strain;Load (N);Ext. (mm)\n0.1;0.23;1.0\n0.2;0.52;NaN\n",
        "Type;Strain;Load (N)\nAverage;0.1;0.23\nAverage;0.2;0.52\n",
        "Strain;Load (N)\n\n0.1;0.23\n\n0.2;0.52\n\n\n",
        "Strain;Load (N)\r\r\n0.1;0.23\r\r\n0.2;0.52\r\r\n",
    ] {
        assert_read(text);
    }
    // lines are counted as they stand in the file
    assert_refused(
        "Strain;Load (N)\n\n0.1;0.23\n\n0.2;x\n",
        Place::Text,
        "line 5",
    );
}

#[test]
fn exports_of_testing_machines_are_read_or_refused() {
    // Zwick testXpert: units on a line, decimal commas
    assert_read(
        "\"Prüfzeit\"\t\"Standardweg\"\t\"Dehnung\"\t\"Standardkraft\"\ns\tmm\t%\tN\n0,1\t2,0\t10,0\t0,23\n0,2\t4,0\t20,0\t0,52\n",
    );
    // Instron Bluehill: what was tested above, units in brackets on a line
    assert_read(
        "Specimen label,\"A-1\"\nWidth,15,mm\n\nTime,Extension,Load,Tensile strain\n(s),(mm),(N),(%)\n\
         0.0,2,0.23,10\n0.1,4,0.52,20\n",
    );
    // MTS TestWorks: fixed columns
    assert_read(
        "Crosshead   Load    Time   Strain\n   mm        N      sec    mm/mm\n 2.0   0.23   1.0  0.1\n 4.0  0.52  2.0  0.2\n",
    );
    // several specimens side by side: which one is asked
    let beside = "Probe 1;;Probe 2;\nDehnung;Kraft;Dehnung;Kraft\n%;N;%;N\n10,0;0,23;10,0;0,24\n20,0;0,52;20,0;0,53\n";
    assert_refused(beside, Place::Column(0), "column 3");
    let column = |number| ColumnHint {
        column: Some(number),
        unit: None,
    };
    let hints = Hints {
        columns: [column("3"), column("4")],
        ..Hints::default()
    };
    let reading = ask(beside, hints).expect("the second specimen");
    assert!((reading.points[1][1] - 0.53).abs() < 1e-12, "{reading:?}");
    // a specimen that broke earlier than the one beside it
    let short = "Dehnung;Kraft;Dehnung;Kraft\n%;N;%;N\n10,0;0,23;10,0;0,24\n;;20,0;0,53\n";
    let hints = Hints {
        columns: [column("1"), column("2")],
        ..Hints::default()
    };
    let refusal = ask(short, hints).expect_err("no number in line 4");
    assert!(refusal.detail.contains("line 4"), "{refusal:?}");
    // results of the specimens above their curves
    assert_refused(
        "Nr;Fmax (N);Dehnung (%)\n1;0,52;20,0\nDehnung (%);Kraft (N)\n10,0;0,23\n20,0;0,52\n",
        Place::Text,
        "line 2",
    );
    // units in the cells, times of day
    assert_refused(
        "Strain;Load (N)\n10 %;0.23 N\n20 %;0.52 N\n",
        Place::Text,
        "no line",
    );
    assert_read("Zeit;Dehnung (%);Kraft (N)\n10:23:11,5;10,0;0,23\n10:23:12,0;20,0;0,52\n");
}
