//! Files for ParaView: lines as VTK XML poly data (`.vtp`), and series of them (`.pvd`).
//!
//! Data is appended raw and compressed with zlib, in blocks as VTK reads them. Layout of an array:
//! number of blocks, bytes of a full block, bytes of the last one if it is not full, compressed
//! bytes of each block, all as unsigned 64-bit numbers, then the blocks.
//!
//! Source: VTK file formats, [`VtkUsersGuide2010`] section 19.3.
use std::io::{self, Write};

use flate2::{Compression, write::ZlibEncoder};

/// Bytes of an uncompressed block; what VTK itself uses.
const BLOCK: usize = 32_768;

/// Points joined by lines, with data on both.
pub(crate) struct Lines<'a> {
    pub(crate) points: &'a [[f64; 3]],
    /// Points at the ends of each line.
    pub(crate) ends: &'a [[u32; 2]],
    pub(crate) point_data: &'a [Array<'a>],
    pub(crate) cell_data: &'a [Array<'a>],
}

/// A named array of numbers.
pub(crate) struct Array<'a> {
    name: &'a str,
    components: usize,
    values: Values<'a>,
}

enum Values<'a> {
    Floats(&'a [f64]),
    Bytes(&'a [u8]),
    Indices(&'a [i32]),
}

/// Snapshots by time, here whatever grows during a test.
pub(crate) struct Series {
    pub(crate) entries: Vec<(f64, String)>,
}

impl<'a> Array<'a> {
    pub(crate) fn scalars(name: &'a str, values: &'a [f64]) -> Self {
        Self::new(name, 1, Values::Floats(values))
    }

    /// Three values for each vector.
    pub(crate) fn vectors(name: &'a str, values: &'a [f64]) -> Self {
        Self::new(name, 3, Values::Floats(values))
    }

    pub(crate) fn bytes(name: &'a str, values: &'a [u8]) -> Self {
        Self::new(name, 1, Values::Bytes(values))
    }

    fn indices(name: &'a str, values: &'a [i32]) -> Self {
        Self::new(name, 1, Values::Indices(values))
    }

    fn new(name: &'a str, components: usize, values: Values<'a>) -> Self {
        Self {
            name,
            components,
            values,
        }
    }

    /// The array's element of the XML header, pointing to `offset` in the appended data.
    fn declare(&self, out: &mut dyn Write, offset: usize) -> io::Result<()> {
        let kind = match self.values {
            Values::Floats(_) => "Float64",
            Values::Bytes(_) => "UInt8",
            Values::Indices(_) => "Int32",
        };
        let (name, components) = (self.name, self.components);
        writeln!(
            out,
            "        <DataArray type=\"{kind}\" Name=\"{name}\" \
             NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>"
        )
    }

    /// The array's appended data.
    fn encode(&self) -> io::Result<Vec<u8>> {
        let bytes: Vec<u8> = match self.values {
            Values::Floats(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            Values::Bytes(values) => values.to_vec(),
            Values::Indices(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        };
        let mut blocks = Vec::new();
        for block in bytes.chunks(BLOCK) {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(block)?;
            blocks.push(encoder.finish()?);
        }
        let head = [blocks.len(), BLOCK, bytes.len() % BLOCK];
        let sizes = head.into_iter().chain(blocks.iter().map(Vec::len));
        let mut encoded: Vec<u8> = sizes.flat_map(|size| (size as u64).to_le_bytes()).collect();
        encoded.extend(blocks.concat());
        Ok(encoded)
    }
}

impl Lines<'_> {
    /// Writes the `.vtp` file.
    ///
    /// # Errors
    /// Those of `out`.
    pub(crate) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let (points, lines) = (self.points.len(), self.ends.len());
        let coordinates: &[f64] = self.points.as_flattened();
        let connectivity: Vec<i32> = self.ends.iter().flatten().map(|end| *end as i32).collect();
        let offsets: Vec<i32> = (1..=lines as i32).map(|line| 2 * line).collect();
        let positions = [Array::vectors("Points", coordinates)];
        let topology = [
            Array::indices("connectivity", &connectivity),
            Array::indices("offsets", &offsets),
        ];
        let sections: [(&str, &[Array<'_>]); 4] = [
            ("PointData", self.point_data),
            ("CellData", self.cell_data),
            ("Points", &positions),
            ("Lines", &topology),
        ];
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        writeln!(
            out,
            "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">"
        )?;
        writeln!(out, "  <PolyData>")?;
        writeln!(
            out,
            "    <Piece NumberOfPoints=\"{points}\" NumberOfVerts=\"0\" \
             NumberOfLines=\"{lines}\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">"
        )?;
        let mut data = Vec::new();
        for (section, arrays) in sections {
            writeln!(out, "      <{section}>")?;
            for array in arrays {
                array.declare(out, data.len())?;
                data.extend(array.encode()?);
            }
            writeln!(out, "      </{section}>")?;
        }
        writeln!(out, "    </Piece>\n  </PolyData>")?;
        write!(out, "  <AppendedData encoding=\"raw\">\n_")?;
        out.write_all(&data)?;
        writeln!(out, "\n  </AppendedData>\n</VTKFile>")
    }
}

impl Series {
    /// Writes the `.pvd` file.
    ///
    /// # Errors
    /// Those of `out`.
    pub(crate) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        writeln!(out, "<VTKFile type=\"Collection\" version=\"1.0\">")?;
        writeln!(out, "  <Collection>")?;
        for (time, file) in &self.entries {
            writeln!(
                out,
                "    <DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>"
            )?;
        }
        writeln!(out, "  </Collection>\n</VTKFile>")
    }
}
