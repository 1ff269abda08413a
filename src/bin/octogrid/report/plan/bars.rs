//! Bars in groups as SVG, from 0 to either side.

use std::error::Error;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::report::numbers::short;
use crate::report::plot::{COLOURS, FONT};

/// The height of a group of bars.
const ROW: u32 = 26;
const WIDTH: u32 = 960;

/// Groups of bars with a name each.
pub(super) struct Bars<'a> {
    pub(super) title: &'a str,
    /// What the bars measure.
    pub(super) unit: &'a str,
    /// The name of each bar of a group.
    pub(super) series: &'a [&'a str],
    /// From top to bottom.
    pub(super) rows: Vec<(String, Vec<f64>)>,
}

/// Draws them.
pub(super) fn svg(bars: &Bars) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    let n = bars.rows.len();
    let area = SVGBackend::with_string(&mut text, (WIDTH, 130 + ROW * n as u32)).into_drawing_area();
    area.fill(&WHITE)?;
    let values = || bars.rows.iter().flat_map(|(_, values)| values.iter().copied());
    let (least, most) = values().fold((0.0, 1.0), |(l, m), v| (f64::min(l, v), f64::max(m, v)));
    let mut chart = ChartBuilder::on(&area)
        .caption(bars.title, (FONT, 18))
        .margin(12)
        .margin_right(150)
        .x_label_area_size(46)
        .y_label_area_size(190)
        .build_cartesian_2d(1.05 * least..1.05 * most, n as f64..0.0)?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .disable_y_axis()
        .x_desc(bars.unit)
        .light_line_style(WHITE)
        .x_label_formatter(&|x| short(*x))
        .label_style((FONT, 13))
        .draw()?;
    let height = 0.8 / bars.series.len() as f64;
    let label = (FONT, 13).into_text_style(&area).pos(Pos::new(HPos::Right, VPos::Center));
    for (row, (name, values)) in bars.rows.iter().enumerate() {
        let top = row as f64 + 0.1;
        let (x, y) = chart.backend_coord(&(1.05 * least, top + 0.4));
        area.draw(&Text::new(name.clone(), (x - 8, y), label.clone()))?;
        for (i, &value) in values.iter().enumerate() {
            let from = top + i as f64 * height;
            let bar = [(0.0, from), (value, from + height)];
            chart.draw_series([Rectangle::new(bar, COLOURS[i].filled())])?;
        }
    }
    for (i, name) in bars.series.iter().enumerate() {
        let (x, y) = (WIDTH as i32 - 140, 60 + 22 * i as i32);
        area.draw(&Rectangle::new([(x, y), (x + 12, y + 12)], COLOURS[i].filled()))?;
        area.draw(&Text::new((*name).to_owned(), (x + 18, y), (FONT, 14)))?;
    }
    area.present()?;
    drop((chart, area));
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_go_both_ways() {
        let rows = vec![("a".to_owned(), vec![50.0, -10.0]), ("b".to_owned(), vec![0.0, 1.0])];
        let bars = Bars { title: "t", unit: "%", series: &["one", "two"], rows };
        assert!(svg(&bars).unwrap().contains("two"));
        assert!(svg(&Bars { rows: Vec::new(), ..bars }).is_ok());
    }
}
