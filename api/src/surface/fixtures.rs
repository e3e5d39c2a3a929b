//! Surfaces that tests know all about.
use nalgebra::Vector3;

/// The box [0, sides], as loose triangles.
pub(crate) fn block(sides: [f64; 3]) -> Vec<[Vector3<f64>; 3]> {
    let faces = super::cuboid([0.0; 3], sides).into_iter();
    faces.map(|corners| corners.map(Into::into)).collect()
}

/// A sphere of triangles: an octahedron, each face divided `times` times.
pub(crate) fn ball(radius: f64, times: u32) -> Vec<[Vector3<f64>; 3]> {
    let mut triangles = Vec::new();
    for octant in 0..8_u32 {
        let sign = |axis: u32| if octant >> axis & 1 == 1 { -1.0 } else { 1.0 };
        let [x, y, z] = [0, 1, 2].map(|axis| Vector3::ith(axis as usize, sign(axis)));
        let is_even = octant.count_ones() % 2 == 0;
        triangles.push(if is_even { [x, y, z] } else { [y, x, z] });
    }
    for _ in 0..times {
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]: [Vector3<f64>; 3]| {
                let [ab, bc, ca] = [a + b, b + c, c + a].map(|sum| sum.normalize());
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    triangles
        .iter()
        .map(|corners| corners.map(|corner| corner * radius))
        .collect()
}
