//! The two plots of a sweep: curves as small multiples, and threshold against friction.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::gallery::{Gallery, GalleryEntry, SettingValue};
use pinswitch_report::{PlotError, drawable};

/// Drawing units per pixel: the drawing library rounds to whole units, and lines must be smooth.
const FINE: i32 = 8;
/// Size of a panel, px.
const PANEL: (i32, i32) = (260, 190);
/// Most panels; more values are divided into as many classes.
const MAX_PANELS: usize = 12;
/// Most curves in a panel, evenly spaced over the variants.
const MAX_CURVES: usize = 40;
/// Height of the title and width of the legend, px.
const TITLE: i32 = 46;
const LEGEND: i32 = 190;
/// Colours from low to high values, perceptually uniform also for the colour-blind (viridis without
/// its palest end).
const RAMP: [(f64, f64, f64); 5] =
    [(68.0, 1.0, 84.0), (59.0, 82.0, 139.0), (33.0, 145.0, 140.0), (94.0, 201.0, 98.0), (202.0, 190.0, 20.0)];
/// Colours of values without an order, distinguishable for the colour-blind (Okabe and Ito).
const PALETTE: [(u8, u8, u8); 8] = [
    (0, 114, 178),
    (213, 94, 0),
    (0, 158, 115),
    (204, 121, 167),
    (86, 180, 233),
    (230, 159, 0),
    (60, 60, 60),
    (190, 180, 20),
];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type DrawResult = Result<(), Box<dyn std::error::Error>>;

/// The values of a field as classes: single values if they are few, else intervals.
struct Classes {
    field: Option<usize>,
    name: String,
    labels: Vec<String>,
    /// Upper ends of intervals; empty for single values.
    ends: Vec<f64>,
    /// Whether the values have an order, as numbers have.
    is_ordered: bool,
}

impl Classes {
    /// The classes of field `field`, at most `most`; one class without a field.
    #[allow(clippy::cast_precision_loss)]
    fn new(gallery: &Gallery, field: Option<usize>, most: usize) -> Self {
        let name = field.map(|i| gallery.fields[i].clone()).unwrap_or_default();
        let Some(i) = field else {
            return Self { field, name, labels: vec![String::new()], ends: Vec::new(), is_ordered: true };
        };
        let mut values: Vec<&SettingValue> = Vec::new();
        for shown in gallery.made() {
            if !values.contains(&&shown.settings[i]) {
                values.push(&shown.settings[i]);
            }
        }
        if values.is_empty() {
            return Self {
                field,
                name,
                labels: vec!["no variant was made".to_owned()],
                ends: Vec::new(),
                is_ordered: true,
            };
        }
        let mut numbers: Vec<f64> = values
            .iter()
            .filter_map(|v| if let SettingValue::Number(x) = v { Some(*x) } else { None })
            .collect();
        numbers.sort_by(f64::total_cmp);
        if values.len() > most && numbers.len() == values.len() {
            let classes = most.min(6);
            let (low, high) = (numbers[0], numbers[numbers.len() - 1]);
            let end = |k: usize| low + (high - low) * k as f64 / classes as f64;
            let ends: Vec<_> = (1..=classes).map(end).collect();
            let labels =
                (0..classes).map(|k| format!("{} to {}", short(end(k)), short(end(k + 1)))).collect();
            return Self { field, name, labels, ends, is_ordered: true };
        }
        let is_ordered = numbers.len() == values.len();
        let labels = if is_ordered {
            numbers.into_iter().map(short).collect()
        } else {
            let mut labels: Vec<_> = values.iter().map(|v| label(v)).collect();
            labels.truncate(most.saturating_sub(1).max(1));
            if values.len() > labels.len() {
                labels.push("other".to_owned());
            }
            labels
        };
        Self { field, name, labels, ends: Vec::new(), is_ordered }
    }

    /// Returns the class of a variant.
    fn class(&self, shown: &GalleryEntry) -> usize {
        let last = self.labels.len().saturating_sub(1);
        match self.field.map(|i| &shown.settings[i]) {
            None => 0,
            Some(SettingValue::Number(x)) if !self.ends.is_empty() => {
                self.ends.iter().position(|end| x <= end).unwrap_or(last)
            }
            Some(value) => {
                let text = label(value);
                self.labels.iter().position(|l| *l == text).unwrap_or(last)
            }
        }
    }

    fn colour(&self, class: usize) -> RGBColor {
        if !self.is_ordered {
            let (red, green, blue) = PALETTE[class % PALETTE.len()];
            return RGBColor(red, green, blue);
        }
        #[allow(clippy::cast_precision_loss)]
        let share = class as f64 / (self.labels.len().max(2) - 1) as f64;
        ramp(share)
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)]
fn ramp(share: f64) -> RGBColor {
    let place = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let (i, t) = ((place as usize).min(RAMP.len() - 2), place.fract() + f64::from(u8::from(share >= 1.0)));
    let (a, b) = (RAMP[i], RAMP[i + 1]);
    let mix = |a: f64, b: f64| (a + (b - a) * t.min(1.0)).round() as u8;
    RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

fn label(setting: &SettingValue) -> String {
    match setting {
        SettingValue::Number(x) => short(*x),
        SettingValue::Text(text) => text.clone(),
    }
}

fn short(x: f64) -> String {
    format!("{}", (x * 1e3).round() / 1e3)
}

/// Draws friction over load of every variant in the gallery, coloured by the field with the largest
/// effect on friction, with one panel per value of the field with the next largest effect. A single
/// field gives one panel.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses a coordinate.
pub(super) fn curves_svg(name: &str, gallery: &Gallery) -> Result<String, PlotError> {
    let ranked = by_effect(gallery);
    let (facet, shade) = (ranked.get(1).copied(), ranked.first().copied());
    let panels = Classes::new(gallery, facet, MAX_PANELS);
    let colours = Classes::new(gallery, shade, 8);
    let single = panels.labels.len() == 1;
    let columns = panels.labels.len().min(4);
    let rows = panels.labels.len().div_ceil(columns);
    let panel = if single { (PANEL.0 * 2, PANEL.1 * 2) } else { PANEL };
    let size = (
        panel.0 * i32::try_from(columns).unwrap_or(1) + LEGEND,
        panel.1 * i32::try_from(rows).unwrap_or(1) + TITLE,
    );
    draw(size, |root| {
        let body = titled(root, &format!("{name}: friction over load"))?;
        let (body, key) = body.split_horizontally((size.0 - LEGEND) * FINE);
        legend(&key, &colours)?;
        let top = gallery.made().flat_map(|s| &s.curve_n).copied().fold(0.1, f64::max) * 1.05;
        let largest_load = gallery.made().filter_map(|s| s.loads_n).fold(0.1, |m: f64, l| m.max(l[1]));
        let places = body.split_evenly((rows, columns));
        for (class, place) in (0..panels.labels.len()).zip(&places) {
            let mut chart = ChartBuilder::on(place);
            chart.margin(6 * FINE).x_label_area_size(34 * FINE).y_label_area_size(42 * FINE);
            if facet.is_some() {
                let caption = format!("{} = {}", short_field(&panels.name), panels.labels[class]);
                chart.caption(caption, ("sans-serif", 13 * FINE));
            }
            let mut chart = chart.build_cartesian_2d(drawable(0.0, largest_load), drawable(0.0, top))?;
            mesh(&mut chart, "load (N)", "friction (N)")?;
            let inside: Vec<_> = gallery.made().filter(|s| panels.class(s) == class).collect();
            for shown in inside.iter().step_by(inside.len().div_ceil(MAX_CURVES).max(1)) {
                let colour = colours.colour(colours.class(shown));
                chart.draw_series(LineSeries::new(
                    points(shown),
                    colour.mix(0.75).stroke_width(fine(3) / 2),
                ))?;
            }
        }
        Ok(())
    })
}

/// Returns the fields in the order of their effect on the friction at the largest load: the
/// variance between the means of their classes. Equal effects keep the order of the sweep.
#[allow(clippy::cast_precision_loss)]
fn by_effect(gallery: &Gallery) -> Vec<usize> {
    let made: Vec<_> = gallery.made().filter_map(|s| Some((s, s.friction_n?[0]))).collect();
    let mean = made.iter().map(|(_, f)| f).sum::<f64>() / made.len().max(1) as f64;
    let effect = |field: usize| {
        let classes = Classes::new(gallery, Some(field), 8);
        let mut sums = vec![(0.0, 0.0); classes.labels.len().max(1)];
        for (shown, friction) in &made {
            let (sum, count) = &mut sums[classes.class(shown)];
            *sum += friction;
            *count += 1.0;
        }
        let between: f64 = sums.iter().filter(|s| s.1 > 0.0).map(|(s, n)| n * (s / n - mean).powi(2)).sum();
        // Effects that differ by rounding errors only are equal.
        (between * 1e6).round()
    };
    let mut ranked: Vec<_> = (0..gallery.fields.len()).map(|field| (effect(field), field)).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    ranked.into_iter().map(|(_, field)| field).collect()
}

/// Height of the text of an empty plot, px.
const EMPTY_HEIGHT: i32 = 40;

/// Draws friction at the largest load over the threshold, with the band of the friction.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses a coordinate.
pub(super) fn threshold_svg(name: &str, gallery: &Gallery) -> Result<String, PlotError> {
    let colours = Classes::new(gallery, by_effect(gallery).first().copied(), 8);
    let all: Vec<_> = gallery.made().filter_map(|s| Some((s, s.threshold_n?, s.friction_n?))).collect();
    let height = if all.is_empty() { EMPTY_HEIGHT } else { PANEL.1 * 2 };
    let size = (PANEL.0 * 2 + LEGEND, height + TITLE);
    let without_threshold = gallery.made().count() - all.len();
    draw(size, |root| {
        let note = if without_threshold > 0 {
            format!(" ({without_threshold} variants have no threshold in their load range)")
        } else {
            String::new()
        };
        let body = titled(root, &format!("{name}: friction against threshold{note}"))?;
        if all.is_empty() {
            let text = "No variant has a threshold in its load range.";
            body.draw(&Text::new(text, (14 * FINE, 14 * FINE), ("sans-serif", 14 * FINE)))?;
            return Ok(());
        }
        let (body, key) = body.split_horizontally((size.0 - LEGEND) * FINE);
        legend(&key, &colours)?;
        let top = all.iter().map(|(_, _, f)| f[2]).fold(0.1, f64::max) * 1.05;
        let right = all.iter().map(|(_, x, _)| *x).fold(0.1, f64::max) * 1.05;
        let mut chart = ChartBuilder::on(&body)
            .margin(6 * FINE)
            .x_label_area_size(38 * FINE)
            .y_label_area_size(46 * FINE)
            .build_cartesian_2d(drawable(0.0, right), drawable(0.0, top))?;
        mesh(
            &mut chart,
            "threshold: load at which silicone carries half of the friction (N)",
            "friction at the largest load (N)",
        )?;
        for (shown, x, [middle, low, high]) in &all {
            let colour = colours.colour(colours.class(shown));
            let bar = [(*x, *low), (*x, *high)];
            chart.draw_series(LineSeries::new(bar, colour.mix(0.25).stroke_width(fine(1))))?;
            chart.draw_series(std::iter::once(Circle::new(
                (*x, *middle),
                3 * FINE,
                colour.mix(0.9).filled(),
            )))?;
        }
        Ok(())
    })
}

fn points(shown: &GalleryEntry) -> Vec<(f64, f64)> {
    let [from, to] = shown.loads_n.unwrap_or_default();
    #[allow(clippy::cast_precision_loss)]
    let last = (shown.curve_n.len().max(2) - 1) as f64;
    #[allow(clippy::cast_precision_loss)]
    shown.curve_n.iter().enumerate().map(|(i, y)| (from + (to - from) * i as f64 / last, *y)).collect()
}

fn draw(size: (i32, i32), paint: impl FnOnce(&Area<'_>) -> DrawResult) -> Result<String, PlotError> {
    let drawing_size = (fine(size.0), fine(size.1));
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, drawing_size).into_drawing_area();
        let painted = root.fill(&WHITE).map_err(Into::into).and_then(|()| paint(&root));
        painted.and_then(|()| Ok(root.present()?)).map_err(|e| PlotError::new(&*e))?;
    }
    let attributes = |(width, height): (u32, u32)| format!(r#"width="{width}" height="{height}""#);
    let shown = (u32::try_from(size.0).unwrap_or(0), u32::try_from(size.1).unwrap_or(0));
    Ok(svg.replacen(&attributes(drawing_size), &attributes(shown), 1))
}

fn titled<'a>(root: &Area<'a>, title: &str) -> Result<Area<'a>, Box<dyn std::error::Error>> {
    let (head, body) = root.split_vertically(TITLE * FINE);
    head.draw(&Text::new(title.to_owned(), (14 * FINE, 14 * FINE), ("sans-serif", 18 * FINE)))?;
    Ok(body)
}

fn legend(area: &Area<'_>, classes: &Classes) -> DrawResult {
    area.draw(&Text::new(
        short_field(&classes.name).to_owned(),
        (10 * FINE, 8 * FINE),
        ("sans-serif", 14 * FINE),
    ))?;
    for (class, label) in classes.labels.iter().enumerate() {
        let y = (34 + 20 * i32::try_from(class).unwrap_or(0)) * FINE;
        area.draw(&PathElement::new(
            [(10 * FINE, y), (32 * FINE, y)],
            classes.colour(class).stroke_width(fine(4)),
        ))?;
        let cut: String = label.chars().take(22).collect();
        area.draw(&Text::new(cut, (40 * FINE, y - 7 * FINE), ("sans-serif", 13 * FINE)))?;
    }
    Ok(())
}

fn mesh<'a, 'b>(
    chart: &mut ChartContext<
        'a,
        SVGBackend<'b>,
        Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
    >,
    x: &str,
    y: &str,
) -> DrawResult {
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.10).stroke_width(fine(1)))
        .x_desc(x)
        .y_desc(y)
        .x_labels(6)
        .y_labels(6)
        .x_label_formatter(&|v| short(*v))
        .y_label_formatter(&|v| short(*v))
        .set_all_tick_mark_size(4 * FINE)
        .axis_style(BLACK.stroke_width(fine(1)))
        .label_style(("sans-serif", 11 * FINE))
        .axis_desc_style(("sans-serif", 12 * FINE))
        .draw()?;
    Ok(())
}

/// Returns the name of a field without its table.
fn short_field(path: &str) -> &str {
    path.split_once('.').map_or(path, |(_, key)| key)
}

fn fine(pixels: i32) -> u32 {
    u32::try_from(pixels * FINE).unwrap_or_default()
}
