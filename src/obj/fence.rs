//! Checks each line of an OBJ or MTL file, and keeps what tobj reads soundly.

use std::fmt::Write;

use super::error::Problem;

/// A line number and what is wrong there.
type Fault = (usize, Problem);

/// What is left of an OBJ file.
#[derive(Debug, Default)]
pub(super) struct Fenced {
    /// `v` lines, and `f` lines of positive vertex indices.
    pub(super) text: String,
    /// The rests of the `mtllib` lines.
    pub(super) libraries: Vec<String>,
    /// The first triangle and the name of each `usemtl`.
    pub(super) runs: Vec<(usize, String)>,
}

const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// The numbers of vertices, texture coordinates and normals so far, and the largest index that a
/// face has named of each, with its line: a face may come before its vertices.
#[derive(Debug, Default)]
struct Indices {
    counts: [usize; 3],
    largest: [(usize, usize); 3],
}

/// Checks an OBJ file.
pub(super) fn obj(text: &str) -> Result<Fenced, Fault> {
    let (mut fenced, mut indices, mut triangles) = (Fenced::default(), Indices::default(), 0);
    for (line, content) in logical_lines(text) {
        let (keyword, rest) = split_keyword(&content);
        match keyword {
            "v" => vertex(rest, &mut fenced.text).map_err(|problem| (line, problem))?,
            "f" => {
                triangles += face(rest, line, &mut indices, &mut fenced.text).map_err(|p| (line, p))? - 2;
            }
            "mtllib" => fenced.libraries.push(rest.to_owned()),
            "usemtl" if rest.is_empty() => return Err((line, Problem::NoName)),
            "usemtl" => fenced.runs.push((triangles, rest.to_owned())),
            _ => {}
        }
        if let Some(kind) = ["v", "vt", "vn"].iter().position(|&k| k == keyword) {
            indices.counts[kind] += 1;
        }
    }
    indices.check()?;
    Ok(fenced)
}

impl Indices {
    /// The index from 1 that a corner names, which may be relative.
    fn resolve(&mut self, kind: usize, index: i64, line: usize) -> Result<usize, Problem> {
        let count = self.counts[kind];
        let absolute = if index < 0 { count as i128 + i128::from(index) + 1 } else { i128::from(index) };
        let absolute = usize::try_from(absolute).ok().filter(|&absolute| absolute > 0);
        let absolute = absolute.ok_or(Problem::IndexOutOfRange { what: KINDS[kind], index, count })?;
        self.largest[kind] = self.largest[kind].max((absolute, line));
        Ok(absolute)
    }

    fn check(&self) -> Result<(), Fault> {
        for (what, (count, (index, line))) in KINDS.into_iter().zip(self.counts.into_iter().zip(self.largest))
        {
            if index > count {
                return Err((line, Problem::IndexOutOfRange { what, index: index as i64, count }));
            }
        }
        Ok(())
    }
}

/// Three coordinates, then nothing, a weight or a colour.
fn vertex(rest: &str, out: &mut String) -> Result<(), Problem> {
    let tokens: Vec<&str> = without_comment(rest).split_whitespace().collect();
    if ![3, 4, 6].contains(&tokens.len()) {
        return Err(Problem::NumberCount { expected: "3, 4 or 6 numbers", found: tokens.len() });
    }
    let weighted = &tokens[..tokens.len().min(4 - usize::from(tokens.len() == 6))];
    let numbers = weighted.iter().map(|token| finite(token)).collect::<Result<Vec<f32>, _>>()?;
    if let Some(&weight) = numbers.get(3) {
        if weight == 0.0 {
            return Err(Problem::ZeroWeight);
        }
        if let Some(axis) = (0..3).find(|&axis| !(numbers[axis] / weight).is_finite()) {
            return Err(Problem::NotFinite(format!("{} / {}", tokens[axis], tokens[3])));
        }
    }
    push_line(out, "v", weighted);
    Ok(())
}

/// Writes the face with its vertex indices alone; returns the number of its corners.
fn face(rest: &str, line: usize, indices: &mut Indices, out: &mut String) -> Result<usize, Problem> {
    out.push('f');
    let mut corners = 0;
    for corner in without_comment(rest).split_whitespace() {
        let bad = || Problem::BadCorner(corner.to_owned());
        for (kind, part) in corner.split('/').enumerate() {
            if kind > 0 && part.is_empty() {
                continue;
            }
            let index = part.parse().map_err(|_| bad())?;
            if kind >= KINDS.len() {
                return Err(bad());
            }
            let absolute = indices.resolve(kind, index, line)?;
            if kind == 0 {
                write!(out, " {absolute}").expect("a string takes all that is written");
            }
        }
        corners += 1;
    }
    out.push('\n');
    if corners < 3 { Err(Problem::TooFewCorners(corners)) } else { Ok(corners) }
}

/// Checks an MTL file: names, `Kd`, `Ke`, `d` and `Tr`; all else is left out.
pub(super) fn mtl(text: &str) -> Result<String, Fault> {
    let mut out = String::new();
    for (line, content) in logical_lines(text) {
        let (keyword, rest) = split_keyword(&content);
        match keyword {
            "newmtl" if rest.is_empty() => return Err((line, Problem::NoName)),
            "newmtl" => push_line(&mut out, keyword, &[rest]),
            "Kd" | "Ke" => numbers(keyword, rest, 3, &mut out).map_err(|problem| (line, problem))?,
            "d" | "Tr" => numbers(keyword, rest, 1, &mut out).map_err(|problem| (line, problem))?,
            _ => {}
        }
    }
    Ok(out)
}

/// `count` numbers; one alone stands for all of them.
fn numbers(keyword: &str, rest: &str, count: usize, out: &mut String) -> Result<(), Problem> {
    let tokens: Vec<&str> = without_comment(rest).split_whitespace().filter(|&t| t != "-halo").collect();
    for token in &tokens {
        finite(token)?;
    }
    match tokens.len() {
        n if n == count => push_line(out, keyword, &tokens),
        1 => push_line(out, keyword, &vec![tokens[0]; count]),
        found => {
            let expected = if count == 1 { "1 number" } else { "1 or 3 numbers" };
            return Err(Problem::NumberCount { expected, found });
        }
    }
    Ok(())
}

fn finite(token: &str) -> Result<f32, Problem> {
    let number: f32 = token.parse().map_err(|_| Problem::NotANumber(token.to_owned()))?;
    if number.is_finite() { Ok(number) } else { Err(Problem::NotFinite(token.to_owned())) }
}

/// Lines with their numbers from 1; a backslash at the end of a line joins it with the next.
fn logical_lines(text: &str) -> impl Iterator<Item = (usize, String)> {
    let mut lines = (1..).zip(text.lines());
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let mut joined = line.to_owned();
        while joined.trim_end().ends_with('\\') {
            joined.truncate(joined.trim_end().len() - 1);
            let Some((_, next)) = lines.next() else { break };
            joined.push(' ');
            joined.push_str(next);
        }
        Some((number, joined))
    })
}

/// The first word and the trimmed rest.
fn split_keyword(line: &str) -> (&str, &str) {
    let line = line.trim();
    let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    (keyword, rest.trim())
}

/// Names may hold a `#`; numbers end there.
fn without_comment(rest: &str) -> &str {
    rest.split('#').next().unwrap_or(rest)
}

fn push_line(out: &mut String, keyword: &str, words: &[&str]) {
    out.push_str(keyword);
    for word in words {
        out.push(' ');
        out.push_str(word);
    }
    out.push('\n');
}
