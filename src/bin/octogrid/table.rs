//! Tables for people.

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, LineStyle, Row, Table};

/// Two columns: what, and how much.
pub(crate) fn pairs<K: ToString, V: ToString>(rows: impl IntoIterator<Item = (K, V)>) -> Table {
    let mut table = plain();
    for (key, value) in rows {
        table.add_row([key.to_string(), value.to_string()]);
    }
    right(table)
}

/// A header and rows of numbers, the first column being names.
pub(crate) fn grid(header: impl Into<Row>, rows: impl IntoIterator<Item = impl Into<Row>>) -> Table {
    let mut table = plain();
    table.set_header(header);
    table.add_rows(rows);
    right(table)
}

fn plain() -> Table {
    let mut table = Table::new();
    table.load_style(NOTHING.header_separator(LineStyle::none().fill('─').junction('─')));
    table
}

/// Aligns all columns but the first to the right.
fn right(mut table: Table) -> Table {
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}
