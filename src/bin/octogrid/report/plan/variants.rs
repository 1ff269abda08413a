//! What is built of a scene to be compared.

use octogrid::{BuildOptions, Forced, Part, Plan, Quality, SceneProfile, Structure};

/// The most triangles that are traced without voxels: it takes as long as there are triangles.
const BRUTE: usize = 512;

/// One way to build a scene.
pub(super) struct Variant {
    pub(super) name: String,
    pub(super) options: BuildOptions,
    /// What it differs in from the plan: one part, everything, or the choice of the structure.
    pub(super) kind: Kind,
}

/// What a variant differs in from the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Plan,
    All,
    /// A part, kept though the plan leaves it out (`true`), or the other way round.
    Flipped(Part, bool),
    /// Built fast.
    Fast,
    Structure,
}

/// The plan, all parts, the plan built fast, the plan with each part that matters the other way round, and every
/// structure.
pub(super) fn variants(profile: &SceneProfile) -> Vec<Variant> {
    let plan = Plan::new(profile, Forced::default());
    let planned = |name: String, forced, kind| Variant {
        name,
        options: BuildOptions { forced, ..Default::default() },
        kind,
    };
    let mut variants = vec![
        planned("plan".to_owned(), Forced::default(), Kind::Plan),
        planned("all parts".to_owned(), Forced::all(true), Kind::All),
    ];
    // Without voxels there is one way to build.
    if plan.keeps(Part::Voxels) {
        let options = BuildOptions { quality: Quality::Fast, ..Default::default() };
        variants.push(Variant { name: "fast".to_owned(), options, kind: Kind::Fast });
    }
    let small = profile.triangles <= BRUTE;
    for part in Part::ALL {
        let keep = !plan.keeps(part);
        // Without voxels there is nothing to keep the others in.
        let matters = if part == Part::Voxels { keep || small } else { plan.keeps(Part::Voxels) };
        if matters {
            let name = format!("{} {}", part.name(), if keep { "on" } else { "off" });
            variants.push(planned(name, Forced::default().with(part, keep), Kind::Flipped(part, keep)));
        }
    }
    let brute = small.then_some(Structure::Brute);
    variants.extend(Structure::ALL.into_iter().chain(brute).map(|structure| Variant {
        name: structure.name().to_owned(),
        options: structure.into(),
        kind: Kind::Structure,
    }));
    variants
}
