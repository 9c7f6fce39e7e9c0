//! The content of a solid as bytes: two solids with the same bytes have the same mesh at the same
//! tolerance.

use super::definition::{Facing, Solid};
use crate::profile::{Contour, Edge, Point2};

impl Solid {
    /// Returns every ring, wall, cap and frame as bytes: numbers as bits, lists after their lengths. For
    /// cache keys, not for files: the format may change between versions.
    pub fn content_bytes(&self) -> Vec<u8> {
        let mut content = Content(Vec::new());
        content.count(self.rings.len());
        for ring in &self.rings {
            content.number(ring.z_mm);
            content.contour(&ring.contour);
        }
        content.count(self.walls.len());
        for wall in &self.walls {
            content.count(wall.lower.0);
            content.count(wall.upper.0);
        }
        content.count(self.caps.len());
        for cap in &self.caps {
            content.count(usize::from(cap.facing == Facing::Up));
            content.count(cap.rings.len());
            cap.rings.iter().for_each(|ring| content.count(ring.0));
        }
        content.count(self.frames.len());
        for frame in &self.frames {
            content.contour(&frame.polygon);
            content.count(frame.holes.len());
            frame.holes.iter().for_each(|hole| content.count(hole.0));
        }
        content.0
    }
}

struct Content(Vec<u8>);

impl Content {
    fn count(&mut self, n: usize) {
        self.0.extend((n as u64).to_le_bytes());
    }

    fn number(&mut self, x: f64) {
        self.0.extend(x.to_bits().to_le_bytes());
    }

    fn point(&mut self, p: Point2) {
        self.number(p.x);
        self.number(p.y);
    }

    fn contour(&mut self, contour: &Contour) {
        self.count(contour.corners().len());
        contour.corners().iter().for_each(|p| self.point(*p));
        for edge in contour.edges() {
            match edge {
                Edge::Line => self.count(0),
                Edge::Arc(arc) => {
                    self.count(1);
                    self.point(arc.centre);
                    for x in [arc.radius_mm, arc.start_rad, arc.sweep_rad] {
                        self.number(x);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_differs_between_solids() {
        let disc = |radius: f64, height: f64| {
            let outline = Contour::circle(Point2::origin(), radius);
            Solid::prism(&outline, &[], 0.0, height, 0.0).unwrap().content_bytes()
        };
        assert_eq!(disc(3.0, 2.0), disc(3.0, 2.0));
        assert_ne!(disc(3.0, 2.0), disc(3.0, 2.0_f64.next_up()));
        assert_ne!(disc(3.0, 2.0), disc(3.0_f64.next_up(), 2.0));
        let square =
            Contour::polygon([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)].map(|(x, y)| Point2::new(x, y)).to_vec());
        assert_ne!(Solid::prism(&square, &[], 0.0, 1.0, 0.0).unwrap().content_bytes(), disc(1.0, 1.0));
    }
}
