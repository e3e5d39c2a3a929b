//! Spheres as text, one a line.
//!
//! `x y z r` as `yade.export.text` writes them, or `x y z r clump` as `yade.export.textClumps`
//! does; any white space between, `#` begins a comment. A clump number of -1 is Yade's for a free
//! sphere. The comment `#format` names other columns, which are refused rather than misread.
use super::text::{ImportError, Imported, Line};

/// The column orders that are read.
const FORMATS: [&str; 2] = ["x_y_z_r", "x_y_z_r_clumpId"];

/// Reads spheres, in the order of their lines.
///
/// # Errors
/// A line that is not four or five columns, a number that is not finite, a radius that is not
/// positive, a clump that is not a whole number from -1 upwards, another format, no spheres.
pub(super) fn read(text: &str) -> Result<Vec<Imported>, ImportError> {
    let mut spheres = Vec::new();
    for (line, comment) in Line::all(text) {
        let format = comment.and_then(|comment| comment.strip_prefix("format"));
        if let Some(format) = format
            .map(str::trim)
            .filter(|format| !FORMATS.contains(format))
        {
            return Err(line.wrong(format, format!("the format {}", FORMATS.join(" or "))));
        }
        let words = line.words();
        let clump = match words.len() {
            0 => continue,
            4 => None,
            5 => {
                let expected = "a clump number from 0 upwards, or -1 for none";
                let number: i64 = line.parse(words[4], expected)?;
                let clump = u32::try_from(number).ok();
                if clump.is_none() && number != -1 {
                    return Err(line.wrong(words[4], expected));
                }
                clump
            }
            _ => return Err(line.wrong(line.text, "x y z r, or x y z r clump")),
        };
        let centre = line.vector(&words, ["x", "y", "z"])?;
        let radius = line.positive(words[3], "r")?;
        spheres.push(Imported {
            clump,
            ..Imported::at(centre, radius)
        });
    }
    if spheres.is_empty() {
        return Err(ImportError::Missing("spheres"));
    }
    Ok(spheres)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn message(text: &str) -> String {
        read(text).expect_err("it is wrong").to_string()
    }

    #[test]
    fn a_settled_bed_is_read() {
        // the first lines of a bed of 2000 spheres
        let text = "0.41254681378039254 0.37405524231340381 0.138809160307617 0.013150957749999999\n\
            0.047291334718804465 0.1311291444039254 0.3372939286731868 0.01363038485\n";
        let spheres = read(text).expect("it is right");
        assert_eq!(spheres.len(), 2);
        let centre = [0.047291334718804465, 0.1311291444039254, 0.3372939286731868];
        assert_eq!(spheres[1], Imported::at(centre, 0.01363038485));
    }

    /// As `export.textClumps` of Yade 2023.02a writes a clump of two.
    #[test]
    fn an_exported_clump_is_read() {
        let text = "#format x_y_z_r_clumpId\n1\t2\t3\t0.5\t3\n1.5\t2\t3\t0.25\t3\n";
        let spheres = read(text).expect("it is right");
        let member = |x, radius| Imported {
            clump: Some(3),
            ..Imported::at([x, 2.0, 3.0], radius)
        };
        assert_eq!(spheres, [member(1.0, 0.5), member(1.5, 0.25)]);
    }

    #[test]
    fn comments_tabs_and_clumps_are_read() {
        let text =
            "#format x_y_z_r\n\n0\t1\t-2e-3\t0.5 # the first\r\n  1 1 1 .25 7\n1 1 2 .25 -1\n#";
        let spheres = read(text).expect("it is right");
        let clumps: Vec<_> = spheres.iter().map(|sphere| sphere.clump).collect();
        assert_eq!(clumps, [None, Some(7), None]);
        assert_eq!(spheres[0], Imported::at([0.0, 1.0, -2e-3], 0.5));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let cases = [
            (
                "0 0 0 1\n0 0 1",
                "line 2: found \"0 0 1\", expected x y z r, or x y z r clump",
            ),
            (
                "0 0 0 1\n\n0 nan 1 1",
                "line 3: found \"nan\", expected y, a finite number",
            ),
            (
                "0 0 0,5 1",
                "line 1: found \"0,5\", expected z, a finite number",
            ),
            (
                "0 0 0 -1",
                "line 1: found \"-1\", expected r, a number above 0",
            ),
            (
                "0 0 0 1 2.5",
                "line 1: found \"2.5\", expected a clump number from 0 upwards, or -1 for none",
            ),
            (
                "0 0 0 1 -2",
                "line 1: found \"-2\", expected a clump number from 0 upwards, or -1 for none",
            ),
            (
                "#format x_y_z_r_matId\n0 0 0 1 2",
                "line 1: found \"x_y_z_r_matId\", expected the format x_y_z_r or x_y_z_r_clumpId",
            ),
            ("# nothing\n", "the file has no spheres"),
        ];
        for (text, expected) in cases {
            assert_eq!(message(text), expected);
        }
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "[-+0-9.e# \\n\\tnaif_]{0,60}") {
            let _ = read(&text);
        }
    }
}
