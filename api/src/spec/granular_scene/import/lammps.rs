//! LAMMPS data files of `atom_style sphere`.
//!
//! A title line, a header (`2000 atoms`, `0 0.45 xlo xhi`, ...), then sections of one line per
//! atom: `Atoms # sphere` with `id type diameter density x y z`, perhaps followed by three image
//! counts, and `Velocities` with `id vx vy vz wx wy wz`. Source: LAMMPS documentation, read_data.
use std::collections::HashMap;

use super::text::{ImportError, Imported, Line};

/// The part of the file a line belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    Header,
    Atoms,
    Velocities,
}

/// Reads a data file: its atoms in the order of section Atoms, at rest unless it has velocities.
/// Bounds of the box are read, and left to the scene's planes.
///
/// # Errors
/// Another atom style, a section or header line that is not known, a wrong number of columns or
/// atoms, repeated ids, numbers that are not finite, diameters and densities that are not positive.
pub(super) fn read(text: &str) -> Result<Vec<Imported>, ImportError> {
    let mut reader = Reader::default();
    let mut section = Section::Header;
    // the first line is a title, whatever it says
    for (line, comment) in Line::all(text).skip(1) {
        if line.text.is_empty() {
            continue;
        }
        if line
            .text
            .starts_with(|first: char| first.is_ascii_alphabetic())
        {
            section = reader.begin(&line, comment)?;
            continue;
        }
        match section {
            Section::Header => reader.header(&line)?,
            Section::Atoms => reader.atom(&line)?,
            Section::Velocities => reader.velocity(&line)?,
        }
    }
    reader.finish()
}

#[derive(Default)]
struct Reader {
    announced: Option<usize>,
    atoms: Vec<Imported>,
    /// Line and place among the atoms of each atom.
    places: HashMap<u64, (usize, usize)>,
    /// Line of each atom's velocity.
    velocities: Option<HashMap<u64, usize>>,
}

impl Reader {
    fn begin(&mut self, line: &Line<'_>, style: Option<&str>) -> Result<Section, ImportError> {
        match line.text {
            "Atoms" => match style {
                None | Some("sphere") => Ok(Section::Atoms),
                Some(style) => Err(line.wrong(style, "the atom style sphere")),
            },
            "Velocities" if self.atoms.is_empty() => {
                Err(line.wrong(line.text, "section Atoms before section Velocities"))
            }
            "Velocities" => {
                self.velocities = Some(HashMap::new());
                Ok(Section::Velocities)
            }
            _ => Err(line.wrong(line.text, "section Atoms or Velocities")),
        }
    }

    fn header(&mut self, line: &Line<'_>) -> Result<(), ImportError> {
        let words = line.words();
        match words[..] {
            [count, "atoms"] => self.announced = Some(line.parse(count, "a number of atoms")?),
            [_, "atom", "types"] => {}
            [lower, upper, low, high] if BOUNDS.contains(&[low, high]) => {
                if line.number(lower, low)? >= line.number(upper, high)? {
                    return Err(line.wrong(line.text, format!("{low} below {high}")));
                }
            }
            // no bonds, no angles, no ellipsoids
            ["0", ..] if words.len() > 1 => {}
            _ => {
                let expected = "\"N atoms\", \"N atom types\", or bounds like \"0 1 xlo xhi\"";
                return Err(line.wrong(line.text, expected));
            }
        }
        Ok(())
    }

    fn atom(&mut self, line: &Line<'_>) -> Result<(), ImportError> {
        let words = line.words();
        if ![7, 10].contains(&words.len()) {
            let expected = "id type diameter density x y z, and perhaps three image counts";
            return Err(line.wrong(line.text, expected));
        }
        let id = line.parse(words[0], "an atom id")?;
        line.parse::<u32>(words[1], "an atom type")?;
        let radius = 0.5 * line.positive(words[2], "diameter")?;
        let density = line.positive(words[3], "density")?;
        let centre = line.vector(&words[4..7], ["x", "y", "z"])?;
        let place = (line.number, self.atoms.len());
        if let Some((first_line, _)) = self.places.insert(id, place) {
            return Err(ImportError::Repeated {
                line: line.number,
                id,
                first_line,
            });
        }
        self.atoms.push(Imported {
            density: Some(density),
            ..Imported::at(centre, radius)
        });
        Ok(())
    }

    fn velocity(&mut self, line: &Line<'_>) -> Result<(), ImportError> {
        let words = line.words();
        if words.len() != 7 {
            return Err(line.wrong(line.text, "id vx vy vz wx wy wz"));
        }
        let id = line.parse(words[0], "an atom id")?;
        let Some(&(_, place)) = self.places.get(&id) else {
            return Err(line.wrong(words[0], "the id of an atom in section Atoms"));
        };
        let seen = self.velocities.get_or_insert_default();
        if let Some(first_line) = seen.insert(id, line.number) {
            return Err(ImportError::Repeated {
                line: line.number,
                id,
                first_line,
            });
        }
        let atom = &mut self.atoms[place];
        atom.velocity = line.vector(&words[1..4], ["vx", "vy", "vz"])?;
        atom.angular_velocity = line.vector(&words[4..7], ["wx", "wy", "wz"])?;
        Ok(())
    }

    fn finish(self) -> Result<Vec<Imported>, ImportError> {
        let announced = self
            .announced
            .ok_or(ImportError::Missing("number of atoms in its header"))?;
        let velocities = self.velocities.as_ref().map(HashMap::len);
        for (section, found) in [
            ("Atoms", Some(self.atoms.len())),
            ("Velocities", velocities),
        ] {
            if let Some(found) = found.filter(|found| *found != announced) {
                return Err(ImportError::Count {
                    section,
                    announced,
                    found,
                });
            }
        }
        if self.atoms.is_empty() {
            return Err(ImportError::Missing("atoms"));
        }
        Ok(self.atoms)
    }
}

/// Pairs of header words that bound the box.
const BOUNDS: [[&str; 2]; 3] = [["xlo", "xhi"], ["ylo", "yhi"], ["zlo", "zhi"]];

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The beginning of a bed of 2000 spheres.
    const BED: &str = "pack

2 atoms
1 atom types

0 0.45 xlo xhi
0 0.45 ylo yhi
-0.01 0.4458558228826704 zlo zhi

Atoms # sphere

1 1 0.026301915499999998 2600 0.41254681378039254 0.37405524231340381 0.138809160307617
2 1 0.0272607697 2600 0.047291334718804465 0.1311291444039254 0.3372939286731868
";

    const VELOCITIES: &str = "
Velocities

2 0 0 -1.5 0 0 0.25
1 1 2 3 4 5 6
";

    fn message(text: &str) -> String {
        read(text).expect_err("it is wrong").to_string()
    }

    #[test]
    fn a_settled_bed_is_read() {
        let bed = read(BED).expect("it is right");
        assert_eq!(bed.len(), 2);
        let centre = [0.047291334718804465, 0.1311291444039254, 0.3372939286731868];
        let expected = Imported {
            density: Some(2600.0),
            ..Imported::at(centre, 0.5 * 0.0272607697)
        };
        assert_eq!(bed[1], expected);
    }

    #[test]
    fn velocities_find_their_atoms() {
        let bed = read(&format!("{BED}{VELOCITIES}")).expect("it is right");
        let motion = |atom: &Imported| [atom.velocity, atom.angular_velocity];
        assert_eq!(motion(&bed[0]), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        assert_eq!(motion(&bed[1]), [[0.0, 0.0, -1.5], [0.0, 0.0, 0.25]]);
    }

    #[test]
    fn headers_with_nothing_and_image_counts_are_read() {
        let text = BED
            .replace("1 atom types\n", "0 ellipsoids # none\r\n1 atom types\n")
            .replace("0.138809160307617", "0.138809160307617 0 0 -1");
        assert_eq!(read(&text), read(BED));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let cases = [
            (
                "# sphere",
                "# atomic",
                "line 10: found \"atomic\", expected the atom style sphere",
            ),
            (
                "Atoms",
                "Ellipsoids",
                "line 10: found \"Ellipsoids\", expected section Atoms or Velocities",
            ),
            (
                "2 atoms",
                "3 atoms",
                "the header announces 3 atoms, section Atoms has 2",
            ),
            (
                "2 atoms\n",
                "\n",
                "the file has no number of atoms in its header",
            ),
            (
                "2 atoms",
                "2.5 atoms",
                "line 3: found \"2.5\", expected a number of atoms",
            ),
            ("\n2 1 ", "\n1 1 ", "line 13: atom 1 was already on line 12"),
            (
                "0.0272607697",
                "0",
                "line 13: found \"0\", expected diameter, a number above 0",
            ),
            (
                "0.138809160307617",
                "x",
                "line 12: found \"x\", expected z, a finite number",
            ),
            (
                " 0.3372939286731868",
                "",
                "line 13: found \"2 1 0.0272607697 2600 0.047291334718804465 0.131129144403925\", expected id type diameter density x y z, and perhaps three image counts",
            ),
            (
                "0 0.45 xlo xhi",
                "1 0.45 xlo xhi",
                "line 6: found \"1 0.45 xlo xhi\", expected xlo below xhi",
            ),
            (
                "1 atom types",
                "0.1 0 0 xy xz yz",
                "line 4: found \"0.1 0 0 xy xz yz\", expected \"N atoms\", \"N atom types\", or bounds like \"0 1 xlo xhi\"",
            ),
        ];
        for (from, to, expected) in cases {
            assert_eq!(message(&BED.replacen(from, to, 1)), expected);
        }
        let cases = [
            (
                "\n2 0 0",
                "\n7 0 0",
                "line 17: found \"7\", expected the id of an atom in section Atoms",
            ),
            (
                "\n2 0 0",
                "\n1 0 0",
                "line 18: atom 1 was already on line 17",
            ),
            (
                "2 0 0 -1.5 0 0 0.25\n",
                "",
                "the header announces 2 atoms, section Velocities has 1",
            ),
            (
                "-1.5",
                "inf",
                "line 17: found \"inf\", expected vz, a finite number",
            ),
        ];
        for (from, to, expected) in cases {
            let velocities = VELOCITIES.replacen(from, to, 1);
            assert_eq!(message(&format!("{BED}{velocities}")), expected);
        }
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(cut in 0..BED.len(), tail in "[-+0-9.e# \\nAtomsVel]{0,40}") {
            let _ = read(&format!("{}{tail}", &BED[..cut]));
        }
    }
}
