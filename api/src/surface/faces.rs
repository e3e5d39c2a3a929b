//! Flat walls as triangles.
use super::{Point, Triangle};

/// Two triangles of a flat rectangle with these corners in order.
pub fn rectangle([a, b, c, d]: [Point; 4]) -> [Triangle; 2] {
    [[a, b, c], [a, c, d]]
}

/// The faces of an upright box, normals outward.
pub fn cuboid(lower: Point, upper: Point) -> Vec<Triangle> {
    let corner = |bits: u8| -> Point {
        std::array::from_fn(|axis| match bits >> axis & 1 {
            0 => lower[axis],
            _ => upper[axis],
        })
    };
    // bottom, top, and the four sides, counter-clockwise seen from outside
    let faces: [[u8; 4]; 6] = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let faces = faces.map(|face| rectangle(face.map(corner)));
    faces.concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{cross, dot};

    #[test]
    fn a_box_is_closed_and_as_large_as_it_says() {
        let faces = cuboid([1.0, 2.0, 3.0], [2.0, 4.0, 6.0]);
        // with its sign: normals point outward
        let parts = faces.iter().map(|[a, b, c]| dot(a, &cross(b, c)) / 6.0);
        let volume: f64 = parts.sum();
        assert!((volume - 6.0).abs() < 1e-12, "{volume}");
        assert_eq!(faces.len(), 12);
    }
}
