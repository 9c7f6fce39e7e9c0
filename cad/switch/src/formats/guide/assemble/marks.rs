//! The engraved marks, and the side of the load that they give.

use super::{Assembly, Fixing};
use crate::config::MountKind;
use crate::documents::layout_text;
use crate::parts::LeftOut;

impl Assembly<'_> {
    pub(super) fn is_marked(&self) -> bool {
        self.design().configuration().label.engrave && !self.has_lost(LeftOut::Arrow)
    }

    /// The engraved marks of the left support, and the side of the load.
    pub(super) fn marks(&self) -> String {
        let c = self.design().configuration();
        let marks = match (self.is_marked(), self.has_lost(LeftOut::Label)) {
            (true, false) => {
                let label = &c.label.text;
                let label = if label.is_empty() {
                    format!("the label `{}` of the layout ({})", self.design().label(), layout_text(c))
                } else {
                    format!("the label `{label}`")
                };
                format!(
                    "The outer face of the left support has {label} and an arrow. The arrow points to groove 1, on the side of the load; the `1` is on that side."
                )
            }
            (true, true) => {
                "The arrow on its outer face points to groove 1, on the side of the load; the `1` is on that side.".to_owned()
            }
            (false, _) if !c.label.engrave => {
                "The supports have no marks (`label.engrave = false`). Groove 1 is on the side of the load, which is on the right when you look at the outer face of the left support.".to_owned()
            }
            (false, _) => {
                "The arrow does not fit on the supports. Groove 1 is on the side of the load, which is on the right when you look at the outer face of the left support.".to_owned()
            }
        };
        let has_f = |line: &String| line.contains("F>1") || line.contains("1<F");
        let force = if self.supports().flat_map(|s| &s.engraved).any(has_f) {
            " The letter `F` marks the side of the load."
        } else {
            ""
        };
        let covered = if self.is_marked() && c.mount.kind != MountKind::None {
            " The mounting plate covers the marks; the same marks on the right support stay visible."
        } else {
            ""
        };
        let pen = if self.fixing() == Fixing::Studs && self.bill.pins.number > 0 {
            " Before you put it down, mark the side of groove 1 with a pen on its edge: its outer face is hidden in the next steps."
        } else {
            ""
        };
        format!("{marks}{force}{covered}{pen}")
    }
}
