//! Truth without rounding.
