//! Fibres laid down to a sheet, and where they touch.
