//! The loadframe service.
