//! Areas against what geometry says.
use super::*;
use crate::material::{Material, Orthotropic, PlaneState};
use crate::stiffness::turned;

pub(crate) const FILLER: Substance = Substance {
    material: Material::Isotropic {
        youngs_modulus_mpa: 85.0,
        poisson_ratio: 0.3,
    },
    density_kg_per_m3: 1_200.0,
};

pub(crate) const FIBRE: Substance = Substance {
    material: Material::Orthotropic(Orthotropic {
        modulus_1_mpa: 11_500.0,
        modulus_2_mpa: 6_430.0,
        poisson_ratio_12: 0.28,
        shear_modulus_12_mpa: None,
        modulus_3_mpa: None,
        poisson_ratio_13: None,
        poisson_ratio_23: None,
        shear_modulus_13_mpa: None,
        shear_modulus_23_mpa: None,
    }),
    density_kg_per_m3: 1_800.0,
};

fn section(fibres: Vec<Fibre>) -> Section {
    Section {
        length_mm: 70.0,
        height_mm: 50.0,
        thickness_mm: 1.0,
        state: PlaneState::Stress,
        materials: vec![FILLER, FIBRE],
        matrix: 0,
        matrix_angle_deg: 0.0,
        plies: Vec::new(),
        fibres,
    }
}

fn fibre(through_mm: [f64; 2], angle_deg: f64, thickness_mm: f64) -> Fibre {
    Fibre {
        material: 1,
        through_mm,
        angle_deg,
        thickness_mm,
        length_mm: None,
    }
}

/// Area of fibre in the whole section [mm²].
fn fibre_area(layout: &Layout) -> f64 {
    (0..layout.grid().cells())
        .map(|cell| {
            let [a, b] = layout.grid().sides_mm(cell);
            a * b * layout.fibre_share()[cell]
        })
        .sum()
}

#[test]
fn shares_of_cells_add_up_to_the_band_at_every_angle() {
    for (cells, angle) in (0..24).map(|step| ([7 + step % 5, 9], step as f64 * 15.0)) {
        let whole = section(vec![fibre([33.0, 21.0], angle, 0.7)]);
        let layout = whole.layout(Division::Uniform { cells }).unwrap();
        let band = Band::new(0, &whole.fibres[0], [70.0, 50.0]).unwrap();
        let area = band.polygon().area_and_centroid().0;
        assert!((fibre_area(&layout) - area).abs() < 1e-10, "{angle}");
    }
    // Of a band inside the section the area is thickness times length.
    let mut short = fibre([35.0, 25.0], 33.0, 0.7);
    short.length_mm = Some(30.0);
    let layout = section(vec![short])
        .layout(Division::Uniform { cells: [40, 30] })
        .unwrap();
    assert!((fibre_area(&layout) - 21.0).abs() < 1e-10);
}

#[test]
fn a_band_along_x_fills_the_same_share_of_each_cell_of_its_row() {
    let layout = section(vec![fibre([35.0, 5.0], 0.0, 1.0)])
        .layout(Division::Uniform { cells: [7, 5] })
        .unwrap();
    for cell in 0..35 {
        let expected = if cell < 7 { 0.1 } else { 0.0 };
        assert!((layout.fibre_share()[cell] - expected).abs() < 1e-12);
    }
    // Exactly on a line of the grid half of it lies on either side.
    let layout = section(vec![fibre([35.0, 10.0], 180.0, 1.0)])
        .layout(Division::Uniform { cells: [7, 5] })
        .unwrap();
    assert!((layout.fibre_share()[0] - 0.05).abs() < 1e-12);
    assert!((layout.fibre_share()[7] - 0.05).abs() < 1e-12);
}

#[test]
fn a_graded_grid_has_lines_on_the_faces_of_fibres_along_an_axis() {
    let whole = section(vec![
        fibre([35.0, 5.0], 0.0, 0.7),
        fibre([35.0, 30.0], 0.0, 0.7),
    ]);
    let graded = Division::Graded {
        cells: [10, 10],
        across: 2,
    };
    let layout = whole.layout(graded).unwrap();
    for face in [4.65, 5.35, 29.65, 30.35, 0.0, 50.0] {
        let nearest = layout.grid().y_mm().iter().map(|y| (y - face).abs());
        assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-12, "{face}");
    }
    assert_eq!(layout.grid().columns(), 10);
    assert!(
        layout
            .fibre_share()
            .iter()
            .all(|share| [0.0, 1.0].contains(share))
    );
    assert!((fibre_area(&layout) - 2.0 * 70.0 * 0.7).abs() < 1e-10);
    let sizes: Vec<f64> = layout
        .grid()
        .y_mm()
        .windows(2)
        .map(|p| p[1] - p[0])
        .collect();
    assert!(sizes.iter().all(|&size| size < 5.0 + 1e-9));
    for pair in sizes.windows(2) {
        let ratio = (pair[1] / pair[0]).max(pair[0] / pair[1]);
        assert!(ratio < 1.6, "{ratio}");
    }
    let without = section(Vec::new()).layout(graded).unwrap();
    for (line, &y) in without.grid().y_mm().iter().enumerate() {
        assert!(
            (y - 5.0 * line as f64).abs() < 1e-9,
            "even where there is no fibre"
        );
    }
}

#[test]
fn fibres_that_overlap_are_refused_with_their_place() {
    let crossing = section(vec![
        fibre([35.0, 45.0], 0.0, 0.7),
        fibre([35.0, 25.0], 0.0, 0.7),
        fibre([20.0, 25.0], 90.0, 0.7),
    ]);
    let error = crossing.layout(Division::Uniform { cells: [7, 5] });
    let Err(CompositeError::Overlap {
        first,
        second,
        area_mm2,
        x_mm,
        y_mm,
    }) = error
    else {
        panic!("{error:?}");
    };
    assert!((first == 0 || first == 1) && second == 2);
    assert!((area_mm2 - 0.49).abs() < 1e-12);
    assert!((x_mm - 20.0).abs() < 1e-12 && (y_mm - [45.0, 25.0][first]).abs() < 1e-12);
    // Side by side is not over each other.
    let touching = section(vec![
        fibre([35.0, 25.0], 10.0, 0.7),
        fibre(
            [
                35.0 - 0.7 * 10f64.to_radians().sin(),
                25.0 + 0.7 * 10f64.to_radians().cos(),
            ],
            10.0,
            0.7,
        ),
    ]);
    assert!(touching.layout(Division::Uniform { cells: [7, 5] }).is_ok());
    let outside = section(vec![fibre([35.0, 60.0], 0.0, 0.7)]);
    assert_eq!(
        outside
            .layout(Division::Uniform { cells: [7, 5] })
            .unwrap_err(),
        CompositeError::FibreOutside { fibre: 0 }
    );
}

#[test]
fn a_cell_holds_the_laminate_of_its_shares() {
    let layout = section(vec![fibre([35.0, 25.0], 30.0, 2.0)])
        .layout(Division::Uniform { cells: [7, 5] })
        .unwrap();
    let own = |place: usize| {
        [FILLER, FIBRE][place]
            .material
            .stiffness(PlaneState::Stress)
            .unwrap()
            .0
    };
    let share = layout.fibre_share()[17];
    assert!(share > 0.05 && share < 0.5);
    let expected = crate::stiffness::laminate(
        &[(1.0 - share, own(0)), (share, turned(&own(1), 30.0))],
        30.0,
    );
    assert!((layout.stiffness()[17] - expected).amax() < 1e-10 * expected.amax());
    let filled = layout.stiffness()[6];
    assert_eq!(filled, own(0));
}

#[test]
fn points_are_found_in_their_cells() {
    let grid = Grid::uniform([70.0, 50.0], [7, 5]);
    assert_eq!(grid.locate([0.0, 0.0]), Some((0, [0.0, 0.0])));
    assert_eq!(grid.locate([70.0, 50.0]), Some((34, [1.0, 1.0])));
    assert_eq!(grid.locate([15.0, 12.5]), Some((8, [0.5, 0.25])));
    assert_eq!(grid.locate([70.1, 0.0]), None);
    assert_eq!(grid.locate([f64::NAN, 0.0]), None);
}

fn ply(material: usize, thickness_mm: f64, angle_deg: f64) -> Ply {
    Ply {
        material,
        thickness_mm,
        angle_deg,
        in_plane_angle_deg: 0.0,
    }
}

fn own(place: usize, angle_deg: f64) -> crate::stiffness::Stiffness {
    [FILLER, FIBRE][place]
        .material
        .stiffness_out_of_plane(PlaneState::Stress, angle_deg)
        .unwrap()
        .0
}

#[test]
fn plies_fill_the_rows_they_lie_in_from_the_bottom() {
    let mut stack = section(Vec::new());
    stack.plies = vec![ply(1, 10.0, 0.0), ply(0, 15.0, 0.0), ply(1, 25.0, 90.0)];
    let layout = stack.layout(Division::Uniform { cells: [7, 5] }).unwrap();
    // Rows of 10 mm: the first ply, the second, 5 mm of it under 5 mm of the third, the third.
    let laminate = crate::stiffness::laminate(&[(0.5, own(0, 0.0)), (0.5, own(1, 90.0))], 0.0);
    let expected = [
        (own(1, 0.0), 1_800.0),
        (own(0, 0.0), 1_200.0),
        (laminate, 1_500.0),
        (own(1, 90.0), 1_800.0),
        (own(1, 90.0), 1_800.0),
    ];
    for (row, (stiffness, density)) in expected.into_iter().enumerate() {
        for column in 0..7 {
            let cell = 7 * row + column;
            assert!((layout.stiffness()[cell] - stiffness).amax() < 1e-12 * stiffness.amax());
            assert!((layout.density[cell] - density).abs() < 1e-9);
        }
    }
    // The fibres of 90° add E₃, ν₂₃ and G₂₃ to what those of 0° tell; nothing is told twice.
    let told: Vec<&str> = layout.notes().iter().map(|(_, n)| n.constant).collect();
    assert_eq!(told, ["G₁₂ [MPa]", "E₃ [MPa]", "ν₂₃", "G₂₃ [MPa]"]);
}

#[test]
fn one_ply_over_the_height_is_the_matrix_turned() {
    let mut matrix = section(Vec::new());
    matrix.matrix = 1;
    matrix.matrix_angle_deg = 25.0;
    let mut stack = section(Vec::new());
    stack.plies = vec![Ply {
        in_plane_angle_deg: 25.0,
        ..ply(1, 50.0, 0.0)
    }];
    let [first, second] = [matrix, stack].map(|section| {
        let layout = section.layout(Division::Uniform { cells: [3, 2] }).unwrap();
        (layout.stiffness().to_vec(), layout.density)
    });
    assert_eq!(first, second);
}

#[test]
fn a_graded_grid_has_lines_on_the_faces_of_plies_and_at_refined_places() {
    let mut stack = section(Vec::new());
    stack.plies = vec![ply(1, 1.0, 0.0), ply(0, 48.0, 0.0), ply(1, 1.0, 0.0)];
    let graded = Division::Graded {
        cells: [10, 10],
        across: 4,
    };
    let refinement = Refinement {
        at_mm: [35.0, 50.0],
        half_width_mm: 0.5,
        cell_mm: 0.05,
    };
    let layout = stack
        .layout_refined(graded, &[refinement], &Default::default())
        .unwrap();
    let grid = layout.grid();
    let near = |lines: &[f64], at: f64| lines.iter().any(|line| (line - at).abs() < 1e-9);
    for face in [1.0, 49.0] {
        assert!(near(grid.y_mm(), face));
    }
    assert!(near(grid.x_mm(), 35.0));
    let rows = grid.y_mm().iter().filter(|&&y| y < 1.0 - 1e-9).count();
    assert_eq!(rows, 4, "so many cells through the lower ply");
    for (lines, middle) in [(grid.x_mm(), 35.0), (grid.y_mm(), 50.0)] {
        let sizes: Vec<[f64; 2]> = lines
            .windows(2)
            .map(|pair| [0.5 * (pair[0] + pair[1]) - middle, pair[1] - pair[0]])
            .collect();
        for [from_place, size] in &sizes {
            if from_place.abs() < 0.5 {
                assert!(*size < 0.05 + 1e-9, "{from_place} {size}");
            }
        }
        for pair in sizes.windows(2) {
            let ratio = (pair[1][1] / pair[0][1]).max(pair[0][1] / pair[1][1]);
            assert!(ratio < 1.6, "{ratio}");
        }
    }
    // A fibre through two plies, in cells that hold one ply each, leaves what it does not fill.
    stack.fibres = vec![fibre([35.0, 25.0], 90.0, 7.0)];
    let mass: f64 = {
        let layout = stack.layout(graded).unwrap();
        (0..layout.grid().cells())
            .map(|cell| {
                let [a, b] = layout.grid().sides_mm(cell);
                a * b * layout.density[cell]
            })
            .sum()
    };
    let expected = 7.0 * 50.0 * 1_800.0 + 63.0 * (2.0 * 1_800.0 + 48.0 * 1_200.0);
    assert!((mass / expected - 1.0).abs() < 1e-10);
    assert!(matches!(
        stack.layout_refined(Division::Uniform { cells: [5, 5] }, &[refinement], &Default::default()),
        Err(CompositeError::OutOfRange { quantity, .. }) if quantity.contains("not graded")
    ));
}

#[test]
fn plies_that_miss_the_height_are_refused_with_both_numbers() {
    let refused = |plies: Vec<Ply>, turn: f64| {
        let mut stack = section(Vec::new());
        stack.plies = plies;
        stack.matrix_angle_deg = turn;
        let error = stack.layout(Division::Uniform { cells: [5, 5] });
        error.unwrap_err().to_string()
    };
    let told = refused(vec![ply(0, 20.0, 0.0), ply(1, 29.9, 0.0)], 0.0);
    assert!(told.contains("49.9 mm") && told.contains("50 mm"), "{told}");
    assert!(refused(vec![ply(0, 0.0, 0.0), ply(1, 50.0, 0.0)], 0.0).contains("thickness"));
    assert!(refused(vec![ply(2, 50.0, 0.0)], 0.0).contains("place of a material"));
    assert!(refused(vec![ply(0, 50.0, 0.0)], 10.0).contains("matrix angle"));
    assert!(refused(vec![ply(0, 50.0, f64::NAN)], 0.0).contains("ply's angle"));
    // Thirds that do not add up to the last digit are accepted, and the top face stays the top.
    let mut thirds = section(Vec::new());
    thirds.plies = vec![ply(0, 50.0 / 3.0, 0.0); 3];
    let layout = thirds.layout(Division::Uniform { cells: [5, 6] }).unwrap();
    assert!((layout.stiffness()[29] - own(0, 0.0)).amax() < 1e-12 * 85.0);
}

/// Two fibres in a line with a gap of 0.2 mm between them, and one that ends outside of the section.
fn broken_fibre() -> Section {
    let short = |x_mm: f64, y_mm: f64, length_mm: f64| Fibre {
        length_mm: Some(length_mm),
        ..fibre([x_mm, y_mm], 0.0, 2.0)
    };
    section(vec![
        short(17.45, 25.0, 34.9),
        short(52.55, 25.0, 34.9),
        short(35.0, 10.0, 90.0),
    ])
}

#[test]
fn grids_have_lines_on_the_ends_of_fibres_along_an_axis() {
    let broken = broken_fibre();
    let graded = Division::Graded {
        cells: [50, 50],
        across: 2,
    };
    let fitted = Division::Fitted { cells: [50, 50] };
    for division in [graded, fitted] {
        let layout = broken.layout(division).unwrap();
        assert_eq!(layout.fit(), Fit::Exact);
        let shares = layout.fibre_share();
        assert!(shares.iter().all(|share| [0.0, 1.0].contains(share)));
        assert!((fibre_area(&layout) - 2.0 * (2.0 * 34.9 + 70.0)).abs() < 1e-9);
        // what lies in the gap is matrix
        let (gap, _) = layout.grid().locate([35.0, 25.01]).unwrap();
        assert!(shares[gap].abs() < 1e-12);
    }
    // so many cells through the gap as through the fibres
    let layout = broken.layout(graded).unwrap();
    let within = |x: &&f64| (34.9 + 1e-9..35.1 - 1e-9).contains(*x);
    assert_eq!(layout.grid().x_mm().iter().filter(within).count(), 1);
    // cells that an end cuts are said to be cut
    for division in [
        Division::Uniform { cells: [50, 50] },
        Division::Fitted { cells: [2, 50] },
    ] {
        assert_eq!(broken.layout(division).unwrap().fit(), Fit::Cut);
    }
}

#[test]
fn fibres_that_end_on_an_edge_or_outside_have_the_grid_of_those_that_run_through() {
    let with = |length_mm| {
        let mut through = fibre([35.0, 25.0], 0.0, 2.0);
        through.length_mm = length_mm;
        section(vec![through])
    };
    for division in [
        Division::Graded {
            cells: [10, 10],
            across: 2,
        },
        Division::Fitted { cells: [10, 10] },
    ] {
        let expected = with(None).layout(division).unwrap();
        for length_mm in [70.0, 71.0, 500.0] {
            let layout = with(Some(length_mm)).layout(division).unwrap();
            assert_eq!(layout.grid(), expected.grid(), "{length_mm}");
            assert_eq!(layout.fit(), Fit::Exact);
        }
    }
}

#[test]
fn narrow_gaps_beside_fibres_that_end_have_as_many_cells_as_fibres() {
    // both 2 mm thick, 0.5 mm apart, the upper one running through
    let rows = |length_mm, division| {
        let mut lower = fibre([20.0, 25.0], 0.0, 2.0);
        lower.length_mm = length_mm;
        let both = section(vec![lower, fibre([35.0, 27.5], 0.0, 2.0)]);
        let layout = both.layout(division).unwrap();
        let within = |y: &&f64| (26.0 + 1e-9..26.5 - 1e-9).contains(*y);
        let inside = layout.grid().y_mm().iter().filter(within).count();
        (inside + 1, layout.fit())
    };
    let cells = [35, 25];
    let graded = |across| Division::Graded { cells, across };
    let fitted = Division::Fitted { cells };
    assert_eq!(rows(Some(40.0), graded(2)), (2, Fit::Exact));
    // where one cell is all, that is said
    assert_eq!(rows(Some(40.0), graded(1)), (1, Fit::OneCell));
    assert_eq!(rows(Some(40.0), fitted), (1, Fit::OneCell));
    // fibres that run through hand nothing over, by whatever length
    for length_mm in [None, Some(500.0)] {
        assert_eq!(rows(length_mm, graded(2)), (1, Fit::Exact));
        assert_eq!(rows(length_mm, fitted), (1, Fit::Exact));
    }
}
