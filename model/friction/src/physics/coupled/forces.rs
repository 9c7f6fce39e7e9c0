//! Forces of a state on other supports, and their derivatives with respect to a dimension.

use super::{Explicit, Node, Workspace, pin_support};
use crate::bed::Bed;
use crate::physics::equilibrium::Supports;
use crate::physics::pair::Pair;

impl Workspace {
    /// Computes the forces of the last state on other supports with as many nodes, at its gap and
    /// tension: on each node without the pins, of the silicone, and of the pins. `None` if the nodes
    /// differ.
    fn forces_on(&self, supports: &Supports<'_>) -> Option<[Vec<Pair>; 3]> {
        let other = Self::new(supports);
        if other.nodes.len() != self.nodes.len() || other.pins != self.pins {
            return None;
        }
        let silicone_n: Vec<Pair> = other
            .nodes
            .iter()
            .zip(&self.gap_mm)
            .map(|(node, gap)| gap.where_negative(*gap * -node.silicone_n_mm))
            .collect();
        let mut node_n = self.string_n(&other.nodes, supports.bed);
        node_n.iter_mut().zip(&silicone_n).for_each(|(sum, force)| *sum = *sum + *force);
        let pins = self.pins.iter().enumerate();
        let pin_n = pins.map(|(k, node)| pin_support(supports, k, self.gap_mm[*node]).0).collect();
        Some([node_n, silicone_n, pin_n])
    }

    /// Computes the force of string and bending on each node, N.
    fn string_n(&self, nodes: &[Node], bed: &Bed) -> Vec<Pair> {
        let (n, u, bending) = (nodes.len(), &self.gap_mm, self.bending_n_mm2(bed));
        let element = |i: usize| {
            let k = (self.tension_n[i] + self.tension_n[i + 1]) * (0.5 * nodes[i].per_element_mm);
            k * (u[i + 1] - u[i])
        };
        (0..n)
            .map(|i| {
                let mut bend = u[i] * nodes[i].bending[0] - Pair::both(nodes[i].bending_load);
                for distance in [1, 2] {
                    if i + distance < n {
                        bend = bend + u[i + distance] * nodes[i].bending[distance];
                    }
                    if i >= distance {
                        bend = bend + u[i - distance] * nodes[i - distance].bending[distance];
                    }
                }
                let string = u[i] * nodes[i].string - Pair::both(nodes[i].string_load);
                let after = if i + 1 < n { element(i) } else { Pair::both(0.0) };
                let before = if i > 0 { element(i - 1) } else { Pair::both(0.0) };
                after - before - self.tension_n[i] * string - bending * bend
            })
            .collect()
    }

    /// Computes the explicit derivatives of the forces with respect to a dimension, by the central
    /// difference between the supports with `step` less and `step` more of it. The state is the
    /// same for both, so that no solver's tolerance enters. `None` if the nodes differ.
    pub(in crate::physics) fn explicit(
        &self,
        [less, more]: [&Supports<'_>; 2],
        step: f64,
    ) -> Option<Explicit> {
        let [below, above] = [self.forces_on(less)?, self.forces_on(more)?];
        let mut slopes = below.into_iter().zip(above).map(|(below, above)| {
            below.iter().zip(&above).map(|(a, b)| (*b - *a) * (0.5 / step)).collect::<Vec<Pair>>()
        });
        Some(Explicit {
            node_n: slopes.next()?,
            silicone_n: slopes.next()?,
            pin_n: slopes.next()?,
            ..Explicit::default()
        })
    }
}
