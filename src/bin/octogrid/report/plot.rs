//! Plots as SVG: a legend beside the axes, where it hides nothing.

use std::error::Error;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;

use super::numbers::short;

const SIZE: (u32, u32) = (960, 560);
/// Width of the legend.
const LEGEND: u32 = 250;
pub(super) const FONT: &str = "sans-serif";
/// Paul Tol's bright colours, which colour-blind people can tell apart, and two more.
pub(super) const COLOURS: [RGBColor; 10] = [
    RGBColor(68, 119, 170),
    RGBColor(238, 102, 119),
    RGBColor(34, 136, 51),
    RGBColor(204, 187, 68),
    RGBColor(102, 204, 238),
    RGBColor(170, 51, 119),
    RGBColor(120, 120, 120),
    RGBColor(0, 0, 0),
    RGBColor(238, 119, 51),
    RGBColor(120, 70, 20),
];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Points of one colour.
pub(super) struct Series {
    pub(super) name: String,
    pub(super) points: Vec<(f64, f64)>,
    /// Whether a line joins them.
    pub(super) joined: bool,
    /// Where it isn't left to the number of the series.
    pub(super) look: Option<Look>,
}

/// How points look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    /// The number of a colour.
    pub(super) colour: usize,
    pub(super) marker: Marker,
}

/// The shape of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Marker {
    Disc,
    Triangle,
    Cross,
    Square,
    /// Around another marker.
    Ring,
    None,
}

impl Marker {
    pub(super) const FILLED: [Marker; 4] = [Self::Disc, Self::Triangle, Self::Cross, Self::Square];
}

impl Look {
    /// Not only colours differ from series to series.
    fn of(i: usize, series: &Series) -> Self {
        series.look.unwrap_or(Self { colour: i, marker: Marker::FILLED[i % 3] })
    }

    fn colour(self) -> RGBColor {
        COLOURS[self.colour % COLOURS.len()]
    }

    fn marker<'a>(self, (x, y): (i32, i32)) -> DynElement<'a, SVGBackend<'a>, (i32, i32)> {
        let (filled, line) = (self.colour().filled(), self.colour().stroke_width(2));
        match self.marker {
            Marker::Disc => Circle::new((x, y), 4, filled).into_dyn(),
            Marker::Triangle => TriangleMarker::new((x, y), 6, filled).into_dyn(),
            Marker::Cross => Cross::new((x, y), 4, line).into_dyn(),
            Marker::Square => Rectangle::new([(x - 4, y - 4), (x + 4, y + 4)], filled).into_dyn(),
            Marker::Ring => Circle::new((x, y), 9, line).into_dyn(),
            Marker::None => EmptyElement::at((x, y)).into_dyn(),
        }
    }
}

/// What axes measure, with units.
pub(super) struct Labels<'a> {
    pub(super) title: &'a str,
    pub(super) x: &'a str,
    pub(super) y: &'a str,
    pub(super) scale: Scale,
}

/// How y runs; x is logarithmic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scale {
    /// From 0.
    Linear,
    /// Points without a logarithm lie on the lower edge, which is labelled 0.
    Log,
}

/// Series over a logarithmic x.
pub(super) fn svg(labels: &Labels, series: &[Series]) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let (left, right) = area.split_horizontally(SIZE.0 - LEGEND);
    let y = || series.iter().flat_map(|s| &s.points).map(|p| p.1);
    match labels.scale {
        Scale::Linear => {
            let most = y().fold(f64::MIN_POSITIVE, f64::max);
            draw(&left, labels, series, 0.0..1.1 * most, 0.0)?;
        }
        Scale::Log => {
            let Range { start, end } = around(y());
            let lowest = if y().any(|y| y <= 0.0) { start / 4.0 } else { start };
            draw(&left, labels, series, (lowest..end).log_scale().base(base(&(lowest..end))), lowest)?;
        }
    }
    legend(&right, series)?;
    area.present()?;
    drop((left, right, area));
    Ok(text)
}

/// `lowest` is the y of the lower edge.
fn draw<Y>(area: &Area, labels: &Labels, series: &[Series], y: Y, lowest: f64) -> Result<(), Box<dyn Error>>
where
    Y: AsRangedCoord<Value = f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let points = || series.iter().flat_map(|s| &s.points);
    let axis = around(points().map(|p| p.0));
    let zeros = lowest > 0.0 && points().any(|p| p.1 <= 0.0);
    let mut chart = ChartBuilder::on(area)
        .caption(labels.title, (FONT, 18))
        .margin(12)
        .x_label_area_size(46)
        .y_label_area_size(64)
        .build_cartesian_2d(axis.clone().log_scale().base(base(&axis)), y)?;
    chart
        .configure_mesh()
        .x_desc(labels.x)
        .y_desc(labels.y)
        .x_labels(8)
        .y_labels(8)
        .x_label_formatter(&|x| short(*x))
        .y_label_formatter(&|y| short(*y))
        .label_style((FONT, 13))
        .axis_desc_style((FONT, 15))
        .light_line_style(WHITE)
        .draw()?;
    for (i, series) in series.iter().enumerate() {
        let look = Look::of(i, series);
        if series.joined {
            let points = series.points.iter().map(|&(x, y)| (x, y.max(lowest)));
            chart.draw_series(LineSeries::new(points, look.colour().stroke_width(2)))?;
        }
        for &(x, y) in &series.points {
            area.draw(&look.marker(chart.backend_coord(&(x, y.max(lowest)))))?;
        }
    }
    if zeros {
        let corner = chart.backend_coord(&(axis.start, lowest));
        area.draw(&Text::new("0", (corner.0 - 16, corner.1 - 7), (FONT, 13)))?;
    }
    Ok(())
}

fn legend(area: &Area, series: &[Series]) -> Result<(), Box<dyn Error>> {
    for (i, series) in series.iter().enumerate() {
        let (look, y) = (Look::of(i, series), 60 + 24 * i as i32);
        if series.joined {
            area.draw(&PathElement::new([(6, y), (30, y)], look.colour().stroke_width(2)))?;
        }
        area.draw(&look.marker((18, y)))?;
        area.draw(&Text::new(series.name.clone(), (40, y - 7), (FONT, 14)))?;
    }
    Ok(())
}

/// The ratio of labels: powers of ten where there are enough of them, else of two.
fn base(range: &Range<f64>) -> f64 {
    if range.end / range.start > 100.0 { 10.0 } else { 2.0 }
}

/// An interval with room around positive values.
fn around(values: impl Iterator<Item = f64>) -> Range<f64> {
    let positive = values.filter(|&x| x > 0.0);
    let (low, high) = positive.fold((f64::INFINITY, 0.0), |(low, high), x| (x.min(low), x.max(high)));
    if high > 0.0 { low / 1.3..high * 1.3 } else { 0.1..1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_to_plot_is_no_failure() {
        let labels = Labels { title: "none", x: "x", y: "y", scale: Scale::Linear };
        assert!(svg(&labels, &[]).unwrap().contains("<svg"));
    }
}
