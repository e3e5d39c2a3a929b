//! The corners of cells: what stands at them, and how much of each a point in a cell is.

/// A vector at every corner, one array per component.
pub(super) type Vectors = [Vec<f32>; 3];

/// Values at the corners of a cell, x running faster than y.
pub(super) type Corners = [f32; 4];

/// Nothing at so many corners.
pub(super) fn zeros(corners: usize) -> Vectors {
    [vec![0.0; corners], vec![0.0; corners], vec![0.0; corners]]
}

/// Weights of the corners of a cell at coordinates in it.
pub(super) fn weights([x, y]: [f32; 2]) -> Corners {
    [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y]
}

/// How much the weights of a cell's corners change along a difference, both in units of the cell:
/// exact for differences within the cell that have their middle `at` these coordinates.
pub(super) fn weight_differences([x, y]: [f32; 2], [dx, dy]: [f32; 2]) -> Corners {
    [
        -(1.0 - y) * dx - (1.0 - x) * dy,
        (1.0 - y) * dx - x * dy,
        -y * dx + (1.0 - x) * dy,
        y * dx + x * dy,
    ]
}

/// How far the corners of a cell are from its first one, `across` corners in a row.
pub(super) fn offsets(across: usize) -> [usize; 4] {
    [0, 1, across, across + 1]
}
