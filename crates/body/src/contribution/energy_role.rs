//! [`EnergyRole`]: where the energy balance of a motion counts the work of a contribution.

/// Which entry of the energy balance of a motion (`EnergyLedger`) counts the work of the force of a contribution.
/// What [touches](crate::contribution::Contribution::touches) is counted as contact and friction, whatever its role.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EnergyRole {
    /// The potential without loads, designs as they are, is stored energy; what loads add to the force does the work of drives, and what velocities add
    /// dissipates.
    #[default]
    Stored,
    /// The force is that of a given load.
    Load,
    /// The force is that of the fluid in a chamber.
    Pressure,
    /// The force is that of a drive.
    Drive,
}
