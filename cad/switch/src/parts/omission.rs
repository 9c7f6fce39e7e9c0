//! Features that can be left out of a part.

/// A feature that is left out where it does not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOut {
    /// The engraved label.
    Label,
    /// `L` or `R` on a support.
    Side,
    /// The arrow to groove 1 on a support, and its `1`.
    Arrow,
    /// The lip over the edge of the silicone.
    Lip,
    /// The stops at the ends of the layer.
    Stops,
    /// Traps for the nuts in the right support.
    NutTraps,
    /// Counterbores for the heads in a support.
    Counterbores,
    /// Counterbores for the heads in the mounting plate.
    PlateCounterbores,
}
