//! Exports of testing machines, in the forms that their programs write: one list of what is read and what
//! is refused, so that a new form is seen beside all others.
use super::*;

const STRAIN: [&str; 2] = ["nominal_strain", "force_n"];

fn wanted(names: [&str; 2]) -> [Wanted; 2] {
    names.map(|name| Wanted {
        name: name.to_owned(),
    })
}

fn points(text: &str) -> Vec<[f64; 2]> {
    read_with(text, Hints::default()).points
}

fn read_with(text: &str, hints: Hints<'_>) -> Reading {
    read(text, &wanted(STRAIN), &hints).unwrap_or_else(|refusal| panic!("{refusal:?} of {text}"))
}

fn refusal(text: &str) -> Refusal {
    refusal_with(text, Hints::default())
}

fn refusal_with(text: &str, hints: Hints<'_>) -> Refusal {
    match read(text, &wanted(STRAIN), &hints) {
        Ok(reading) => panic!("{text} was read as {reading:?}"),
        Err(refusal) => refusal,
    }
}

/// 2 ε + 3 ε² at 10 and 20 %.
const TWO: [[f64; 2]; 2] = [[0.1, 0.23], [0.2, 0.52]];

fn assert_two(text: &str) {
    let found = points(text);
    let near = |one: &[f64; 2], other: &[f64; 2]| {
        (0..2).all(|part| (one[part] - other[part]).abs() <= 1e-12)
    };
    assert!(
        found.len() == 2 && found.iter().zip(&TWO).all(|(one, other)| near(one, other)),
        "{found:?} from {text}"
    );
}

#[test]
fn columns_are_found_by_name_and_unit_in_any_order() {
    for text in [
        "nominal_strain,force_n\n0.1,0.23\n0.2,0.52\n",
        "Tensile strain (mm/mm),Extension (mm),Load (N)\n0.1,2,0.23\n0.2,4,0.52\n",
        "Load (N),Tensile strain (mm/mm),Extension (mm)\n0.23,0.1,2\n0.52,0.2,4\n",
        "time_s,displacement_mm,force_n,nominal_strain\n1.2,2,0.23,0.1\n2.4,4,0.52,0.2\n",
        "Load [mN];Strain [%]\n230;10\n520;20\n",
        "Kraft in cN\tDehnung in %\n23\t10\n52\t20\n",
        "F / N;ε / %\n0.23;10\n0.52;20\n",
        "Time (s),Tensile strain (Strain 1) (%),Load (kN)\n1,10,0.00023\n2,20,0.00052\n",
        "Strain %,Force N\n10,0.23\n20,0.52\n",
        "Strain\tLoad/N\n0.1\t0.23\n0.2\t0.52\n",
        "Dehnung;Kraft\n0,1;0,23\n0,2;0,52\n",
        "Strain mm/mm\tWeg in m\tLoad N\n0.1\t2\t0.23\n0.2\t4\t0.52\n",
        "Strain   Load/N\n0.1   0.23\n0.2   0.52\n",
        "Síla (N);Poměrné prodloužení (%)\n0,23;10,0\n0,52;20,0\n",
    ] {
        assert_two(text);
    }
}

#[test]
fn exports_are_read_as_programs_write_them() {
    for text in [
        // names and units on two lines, quotes, a preamble
        "\"Specimen 1\"\n\n\"Operator\",\"A. Smith\"\n\"Time\",\"Tensile strain\",\"Load\"\n\
         \"(sec)\",\"(%)\",\"(N)\"\n\"0.1\",\"10.00\",\"0.23\"\n\"0.2\",\"20.00\",\"0.52\"\n",
        // as Excel writes it where commas are decimal
        "sep=;\r\nDehnung [%];Kraft [N]\r\n10,0;0,23\r\n20,0;0,52\r\n",
        "\u{feff}\"Prüfer\";\"X\"\n\"Dehnung\";\"Standardkraft\"\n\"%\";\"N\"\n10,0;0,23\n20,0;0,52\n",
        // decimal commas within quotes between commas
        "Strain (%),Load (N)\n\"10,0\",\"0,23\"\n\"20,0\",\"0,52\"\n",
        "Crosshead\tLoad\tTime\tStrain\nmm\tN\tsec\tmm/mm\n2\t0.23\t1\t0.1\n4\t0.52\t2\t0.2\n",
        // separators at the ends of lines, empty lines, other columns of words
        "Strain (%);Load (N);\n10.0;0.23;\n\n20.0;0.52;\n\n",
        "Strain (%);Event;Load (N)\n10.0;start;0.23\n20.0;;0.52\n",
        // bytes of UTF-16 that were read one by one
        "\u{ff}\u{fe}S\x00t\x00r\x00a\x00i\x00n\x00,\x00L\x00o\x00a\x00d\x00 \x00(\x00N\x00)\x00\n\x000\x00.\x001\x00,\x000\x00.\x002\x003\x00\n\x00\
         0\x00.\x002\x00,\x000\x00.\x005\x002\x00\n\x00",
        "\u{ef}\u{bb}\u{bf}Strain,Load (N)\n0.1,0.23\n0.2,0.52\n",
    ] {
        assert_two(text);
    }
}

#[test]
fn files_are_read_from_their_bytes() {
    use base64::{Engine as _, prelude::BASE64_STANDARD};
    let text = "Dehnung [%];Kraft [µN]\r\n10,0;230000,0\r\n20,0;520000,0\r\n";
    let little = text.encode_utf16().flat_map(u16::to_le_bytes);
    let little: Vec<u8> = [0xff, 0xfe].into_iter().chain(little).collect();
    let big = text.encode_utf16().flat_map(u16::to_be_bytes);
    let big: Vec<u8> = [0xfe, 0xff].into_iter().chain(big).collect();
    let western = text
        .chars()
        .map(|c| u8::try_from(c).expect("a Western letter"))
        .collect();
    for bytes in [little, big, western, text.as_bytes().to_vec()] {
        assert_two(&BASE64_STANDARD.encode(bytes));
    }
    for (bytes, word) in [
        (
            &b"\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03 and so on"[..],
            "gzip",
        ),
        (
            &b"PK\x03\x04 and what a workbook goes on with"[..],
            "workbook",
        ),
    ] {
        let refusal = refusal(&BASE64_STANDARD.encode(bytes));
        assert!(refusal.detail.contains(word), "{refusal:?}");
    }
}

#[test]
fn what_was_understood_is_said() {
    let reading = read_with(
        "Specimen 7\nStrain\tLoad (mN)\n0.0200\t41\n0.3400\t1,027\n",
        Hints::default(),
    );
    assert_eq!(reading.points, [[0.02, 0.041], [0.34, 1.027]]);
    assert_eq!(
        reading.words,
        [
            "2 points from line 3 on, cells parted by tabs, points before decimals, commas between \
             thousands",
            "column 1 'Strain' as nominal_strain, a pure number",
            "column 2 'Load (mN)' as force_n, times 0.001",
        ]
    );
}

#[test]
fn extensions_become_strains_by_the_gauge_length() {
    let text = "Extension (mm),Load (N)\n2,0.23\n4,0.52\n";
    let missing = refusal(text);
    assert_eq!(missing.place, Place::GaugeLength, "{missing:?}");
    let hints = Hints {
        gauge_length_mm: Some(20.0),
        ..Hints::default()
    };
    let reading = read_with(text, hints);
    assert_eq!(reading.points, TWO);
    assert_eq!(
        reading.words[1],
        "column 1 'Extension (mm)' over the gauge length of 20 mm (given) as nominal_strain, times 0.05"
    );
    // or by the lines above
    assert_two("Gauge length,2,cm\nExtension (mm),Load (N)\n2,0.23\n4,0.52\n");
    assert_two("Messlänge [mm];20,0\nTraversenweg [mm];Kraft [N]\n2;0,23\n4;0,52\n");
}

#[test]
fn of_several_gauge_lengths_none_is_taken() {
    let curve = "Extension (mm),Load (N)\n2,0.23\n4,0.52\n";
    let [grips, gauge] = ["Grip separation,40,mm\n", "Gauge length,20,mm\n"];
    for lines in [format!("{grips}{gauge}"), format!("{gauge}{grips}")] {
        let open = refusal(&format!("{lines}{curve}"));
        let words = (open.place, open.code);
        assert_eq!(words, (Place::GaugeLength, "ambiguous"), "{open:?}");
        let named = ["line 1", "line 2", "20 mm", "40 mm"];
        assert!(named.iter().all(|n| open.detail.contains(n)), "{open:?}");
        // the user's decides: 2 mm over 20 mm
        let hints = Hints {
            gauge_length_mm: Some(20.0),
            ..Hints::default()
        };
        assert_eq!(read_with(&format!("{lines}{curve}"), hints).points, TWO);
        // and none is asked for where the strain stands in the table
        assert_two(&format!("{lines}Strain,Load (N)\n0.1,0.23\n0.2,0.52\n"));
    }
    // the same one twice, in other units
    assert_two(&format!("{gauge}Grip separation,2,cm\n{curve}"));
}

#[test]
fn a_gauge_length_tells_its_decimals_where_the_table_is_of_whole_numbers() {
    let whole = |length: &str| format!("Messlänge;{length};mm\nWeg [µm];Kraft [mN]\n2000;230\n");
    let open = refusal(&whole("20,000"));
    assert_eq!((open.place, open.code), (Place::Decimal, "ambiguous"));
    assert!(open.detail.contains("line 1"), "{open:?}");
    let hints = |decimal| Hints {
        decimal: Some(decimal),
        ..Hints::default()
    };
    // 2 mm over 20 mm, and over 20 m
    let text = whole("20,000");
    let strain = |reading: Reading| reading.points[0][0];
    for (decimal, expected) in [(DecimalMark::Comma, 0.1), (DecimalMark::Point, 1e-4)] {
        let found = strain(read_with(&text, hints(decimal)));
        assert!((found / expected - 1.0).abs() < 1e-12, "{found}");
    }
    for length in ["20", "20,0", "20.0", "020,000"] {
        let found = points(&whole(length));
        assert!((found[0][0] - 0.1).abs() < 1e-12, "{found:?} from {length}");
    }
    // the table's mark goes before: 20 m
    let found = points("Messlänge;20,000;mm\nWeg [mm];Kraft [N]\n2.0;0.23\n");
    assert!((found[0][0] - 1e-4).abs() < 1e-15, "{found:?}");
}

#[test]
fn numbers_that_can_be_read_in_two_ways_are_refused_unless_others_tell() {
    let open = refusal("Strain (%);Load (N)\n10;1,027\n20;2,500\n");
    assert_eq!((open.place, open.code), (Place::Decimal, "ambiguous"));
    assert!(open.detail.contains("1.027 or 1027"), "{open:?}");
    let hints = |decimal| Hints {
        decimal: Some(decimal),
        ..Hints::default()
    };
    let text = "Strain (%);Load (N)\n10;1,027\n";
    assert_eq!(
        read_with(text, hints(DecimalMark::Comma)).points,
        [[0.1, 1.027]]
    );
    assert_eq!(
        read_with(text, hints(DecimalMark::Point)).points,
        [[0.1, 1027.0]]
    );
    assert_eq!(points("Strain (%);Load (N)\n10,0;1,027\n"), [[0.1, 1.027]]);
    assert_eq!(points("Strain (%);Load (N)\n10.0;1,027\n"), [[0.1, 1027.0]]);
    let both = refusal("Strain (%);Load (N)\n10.5;0,027\n");
    assert_eq!((both.place, both.code), (Place::Decimal, "ambiguous"));
    // a comma that parts cells and decimals
    for text in [
        "Strain,Load (N)\n0,02,0,041\n",
        "0,02,0,041\n0,04,0,085\n",
        "Strain,Load (N)\n0,02,1\n",
    ] {
        assert_eq!(refusal(text).code, "ambiguous", "{text}");
    }
}

#[test]
fn no_line_is_dropped_without_a_word() {
    for (text, line) in [
        ("Strain,Load (N)\nO.1,0.23\n0.2,0.52\n", "line 2"),
        ("Strain,Load (N)\n0.1,0.23\n0.2,x\n", "line 3"),
        ("Strain,Load (N)\n0.1,0.23\n0.2\n", "line 3"),
        ("Strain,Load (N)\n0.1,0.23\nend of test\n", "line 3"),
        ("x,0.23\n0.2,0.52\n", "line 1"),
        ("Strain,Load (N)\n0.1,inf\n", "no line"),
        (
            "Strain,Load (N)\n0.1,0.23\nStrain,Load (N)\n0.2,0.52\n",
            "line 2",
        ),
        ("Strain,Load (N)\nO.1,O.23\n0.2,0.52\n", "line 2"),
    ] {
        let refusal = refusal(text);
        assert!(refusal.detail.contains(line), "{refusal:?} of {text}");
    }
    // a broken line below the names does not pass for names
    let hints = Hints {
        columns: ["1", "2"].map(|column| ColumnHint {
            column: Some(column),
            unit: Some("1"),
        }),
        ..Hints::default()
    };
    let broken = refusal_with("Strain,Load (N)\nO.1,O.23\n0.2,0.52\n", hints);
    assert_eq!(broken.place, Place::Text, "{broken:?}");
}

#[test]
fn a_quote_that_hides_points_is_refused_and_one_that_does_not_is_read() {
    for (text, lines) in [
        // up to the next quote, which stands lines below, in the next line, or nowhere
        (
            "Strain;Load (N);Remark\n0.1;0.2;x\n0.2;0.4;\"start\n0.3;0.6;x\n0.4;0.8;end\"\n0.5;1;x\n",
            ["line 3", "up to 5"],
        ),
        (
            "Strain;Load (N);Remark\n0.1;0.2;\"start\n0.2;0.4;end\"\n",
            ["line 2", "up to 3"],
        ),
        (
            "Operator\n\nStrain;Load (N);Remark\n0.1;0.2;x\n\n0.2;0.4;\"a\n0.3;0.6;x\n",
            ["line 6", "up to 7"],
        ),
        (
            "\"Strain\",\"Load (N)\",\"Remark\"\n\"0.1\",\"0.2\",\"a\n\"0.2\",\"0.4\",\"b\"\n",
            ["line 2", "up to 3"],
        ),
    ] {
        let refusal = refusal(text);
        assert_eq!(refusal.code, "syntax", "{refusal:?} of {text}");
        let all = lines.iter().all(|line| refusal.detail.contains(line));
        assert!(all, "{refusal:?} of {text}");
    }
    // titles and remarks of several lines, as spreadsheets write them
    for text in [
        "Notes;\"conditioned\nat 23 °C\"\nStrain;\"Load\n(N)\"\n0.1;0.23\n0.2;0.52\n",
        "Strain;Load (N);Remark\n0.1;0.23;\"slips\nin the jaw\"\n0.2;0.52;\n",
        "Strain;Load (N);Remark\n0.1;0.23;5\" jaws\n0.2;0.52;5\" jaws\n",
    ] {
        assert_two(text);
    }
}

#[test]
fn names_of_two_words_between_spaces_are_refused() {
    let two_words = refusal("Test time   Strain   Load   Width\n0 0.1 0.23 15\n1 0.2 0.52 15\n");
    assert_eq!(
        (two_words.place, two_words.code),
        (Place::Text, "ambiguous")
    );
    let named = ["line 1", "5 words", "line 2", "4"];
    let all = named.iter().all(|part| two_words.detail.contains(part));
    assert!(all, "{two_words:?}");
    // one word a name, or a mark between names of two
    assert_two("Time   Strain   Load/N   Width\n0 0.1 0.23 15\n1 0.2 0.52 15\n");
    assert_two("Test time;Strain;Load (N);Width\n0;0.1;0.23;15\n1;0.2;0.52;15\n");
}

#[test]
fn a_second_table_is_refused_whatever_stands_beside_its_numbers() {
    for (table, line) in [
        ("Strain;Load (N)\n0.1;0.2\n0.2;0.4\n", "line 2"),
        // a column of words, an empty one, both
        ("Strain;Load (N);Status\n0.1;0.2;ok\n0.2;0.4;ok\n", "line 2"),
        ("Strain;;Load (N)\n0.1;;0.2\n0.2;;0.4\n", "line 2"),
        ("Event;Strain;Load (N)\nstart;0.1;0.2\n;0.2;0.4\n", "line 2"),
        ("Event;;Strain;Load (N)\n;;0.1;0.2\n;;0.2;0.4\n", "line 2"),
        // a word before each number passes for a label, but the names come again
        (
            "A;Strain;B;Load (N)\nok;0.1;ok;0.2\nok;0.2;ok;0.4\n",
            "line 2",
        ),
        // of one point
        ("Strain;Load (N);Status\n0.1;0.2;ok\n", "line 2"),
    ] {
        let refusal = refusal(&format!("{table}{table}"));
        let words = (refusal.place, refusal.code);
        assert_eq!(words, (Place::Text, "ambiguous"), "{refusal:?} of {table}");
        assert!(refusal.detail.contains(line), "{refusal:?} of {table}");
    }
    // one of other columns
    let results = "No;Name;Fmax (N);E (MPa)\n1;A;12.3;3000\nStrain;Load (N)\n0.1;0.23\n";
    assert!(refusal(results).detail.contains("line 2"));
}

#[test]
fn what_a_machine_says_of_the_specimen_is_no_table() {
    for line in [
        "Width;15;Thickness;0.1",
        "Width;15;mm;Thickness;0.1;mm\nLength;100;mm;Speed;10;mm/min",
        "Operator;A. Smith\nWidth;15;Thickness;0.1\nLength;100;Span;50",
        "Date;12.03.2024;10:23:11\nPrüfgeschwindigkeit;20;mm/min",
        "Range;0;500;N",
        "Standard;ISO 1924-2;2008\nSpecimen;7",
        "23;°C",
        "Strain;Load (N)",
    ] {
        assert_two(&format!("{line}\nStrain;Load (N)\n0.1;0.23\n0.2;0.52\n"));
    }
}

#[test]
fn columns_that_may_be_several_or_none_are_refused() {
    for (text, place) in [
        (
            "Strain 1 (%),Strain 2 (%),Load (N)\n1,2,3\n",
            Place::Column(0),
        ),
        (
            "Strain (%),Load 1 (N),Load 2 (N)\n1,2,3\n",
            Place::Column(1),
        ),
        ("Strain (%),Stress (MPa)\n1,2\n", Place::Column(1)),
        ("Time (s),Load (N)\n1,2\n", Place::Column(0)),
        ("Extension,Load (N)\n1,2\n", Place::Unit(0)),
        ("Elongation,Load\n1,2\n", Place::Unit(0)),
        ("Strain (%),Load\n1,2\n", Place::Unit(1)),
        ("Strain (%),Load (kg)\n1,2\n", Place::Unit(1)),
        ("Strain (%),Load (klb)\n1,2\n", Place::Unit(1)),
        ("1,2,3\n2,3,4\n", Place::Text),
        ("", Place::Text),
        ("no numbers at all", Place::Text),
    ] {
        assert_eq!(refusal(text).place, place, "{text}");
    }
    let hint = |column, unit| ColumnHint { column, unit };
    let hints = Hints {
        columns: [hint(Some("Strain 2"), None), hint(Some("3"), Some("mN"))],
        ..Hints::default()
    };
    let text = "Strain 1 (%),Strain 2 (%),Load\n1,10,230\n2,20,520\n";
    assert_eq!(read_with(text, hints).points, TWO);
    let unknown = Hints {
        columns: [hint(Some("Strain 3"), None), hint(None, None)],
        ..Hints::default()
    };
    assert_eq!(refusal_with(text, unknown).place, Place::Column(0));
    // a hint that contradicts the title
    let other = Hints {
        columns: [hint(None, None), hint(None, Some("kN"))],
        ..Hints::default()
    };
    assert_eq!(
        refusal_with("Strain,Load (N)\n1,2\n", other).code,
        "contradiction"
    );
}

#[test]
fn strains_without_unit_are_pure_numbers_as_far_as_the_job_goes() {
    let hints = Hints {
        reach: Some(0.5),
        ..Hints::default()
    };
    assert_eq!(
        read_with("Strain,Load (N)\n0.1,0.23\n0.2,0.52\n", hints).points,
        TWO
    );
    let percent = refusal_with("Strain,Load (N)\n10,0.23\n20,0.52\n", hints);
    assert_eq!((percent.place, percent.code), (Place::Unit(0), "ambiguous"));
}

#[test]
fn slack_and_preload_move_the_origin() {
    let text = "nominal_strain,force_n\n0,0\n0.25,0\n0.5,1\n0.75,2\n1,4\n";
    let slack = Hints {
        slack: Some([0.5, 1.5]),
        ..Hints::default()
    };
    // the line through 0.5 N at 0.375 and 1.5 N at 0.625 is at 0 N at 0.25
    let reading = read_with(text, slack);
    let expected = [[0.0, 0.0], [0.0, 0.0], [0.2, 1.0], [0.4, 2.0], [0.6, 4.0]];
    assert_eq!(reading.points, expected);
    let preload = Hints {
        preload: Some(1.0),
        ..Hints::default()
    };
    // (0.75 - 0.5)/1.5 and (1 - 0.5)/1.5
    let reading = read_with(text, preload);
    assert_eq!(
        reading.points,
        [[0.0, 1.0], [0.25 / 1.5, 2.0], [0.5 / 1.5, 4.0]]
    );
    let never = Hints {
        preload: Some(9.0),
        ..Hints::default()
    };
    assert_eq!(refusal_with(text, never).place, Place::Preload);
}

#[test]
fn no_text_makes_the_reader_panic() {
    let pieces = [
        "",
        ",",
        ";",
        "\t",
        "\n",
        "\"",
        "1",
        "0,5",
        "1.027",
        "Strain (%)",
        "Load",
        "(N)",
        "sep=",
        "\0",
        "é",
    ];
    let mut state = 7_usize;
    for _ in 0..2_000 {
        let mut text = String::new();
        for _ in 0..12 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            text.push_str(pieces[(state >> 33) % pieces.len()]);
        }
        let _ = read(&text, &wanted(STRAIN), &Hints::default());
    }
}
