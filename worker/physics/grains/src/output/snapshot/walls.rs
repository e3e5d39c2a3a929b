//! Walls as polygons: planes cut to the box of the scene, facets where they are.
use std::io;

use loadframe_harness::{
    Recorder,
    vtk::{Array, Polygons},
};

use crate::step::engine::Engine;

/// Polygons of all walls, each with the number of its wall.
#[derive(Default)]
struct Drawing {
    points: Vec<[f64; 3]>,
    /// Corners of each polygon.
    corners: Vec<usize>,
    /// Wall of each polygon, planes before meshes.
    walls: Vec<usize>,
}

impl Drawing {
    fn polygon(&mut self, wall: usize, corners: &[[f64; 3]]) {
        self.points.extend(corners);
        self.corners.push(corners.len());
        self.walls.push(wall);
    }
}

/// Writes the walls as they are now; nothing in a scene without.
pub(super) fn take(engine: &Engine, name: &str, recorder: &mut dyn Recorder) -> io::Result<()> {
    if engine.wall_count() == 0 {
        return Ok(());
    }
    let drawing = draw(engine);
    let bodies = engine.model.masses.len();
    let mut numbers = Vec::with_capacity(drawing.walls.len());
    let (mut forces, mut velocities) = (Vec::new(), Vec::new());
    for wall in &drawing.walls {
        numbers.push((bodies + wall) as i32);
        forces.extend(engine.wall_force(*wall));
        velocities.extend(engine.wall_velocity(*wall));
    }
    // glyphs of particles, scaled by their radius, leave the corners of walls alone
    let radii = vec![0.0; drawing.points.len()];
    let polygons = Polygons {
        points: &drawing.points,
        corners: &drawing.corners,
        point_data: &[Array::scalars("radius_m", &radii)],
        cell_data: &[
            Array::indices("wall", &numbers),
            Array::vectors("force_n", &forces),
            Array::vectors("velocity_m_per_s", &velocities),
        ],
    };
    recorder.file(name, &mut |out| polygons.write(out))
}

fn draw(engine: &Engine) -> Drawing {
    let mut drawing = Drawing::default();
    let (low, high) = engine.box_of_walls();
    // a plane alone has no box across it
    let [low, high] = [low, high].map(|corner| corner.map(|x| if x.is_finite() { x } else { 0.0 }));
    for (wall, face) in engine.state.faces.iter().enumerate() {
        let [u, v] = [(face.axis + 1) % 3, (face.axis + 2) % 3];
        let corner = |from_u: f64, from_v: f64| {
            let mut corner = [face.position; 3];
            (corner[u], corner[v]) = (from_u, from_v);
            corner
        };
        let corners = [
            corner(low[u], low[v]),
            corner(high[u], low[v]),
            corner(high[u], high[v]),
            corner(low[u], high[v]),
        ];
        drawing.polygon(wall, &corners);
    }
    let planes = engine.state.faces.len();
    for facet in &engine.model.facets.facets {
        let mesh = facet.mesh as usize;
        let pose = &engine.state.poses[mesh];
        let corners = facet.corners.map(|corner| pose.to_global(&corner));
        drawing.polygon(planes + mesh, &corners);
    }
    drawing
}
