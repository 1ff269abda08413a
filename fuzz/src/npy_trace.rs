//! Rays from a NumPy file, hits to one.

use bytemuck::{bytes_of, cast_slice};
use octogrid::{Scene, Structure, builtin, oracle::Agreement};

use super::{answer::Answer, npy};

/// An npy file as `octogrid trace` reads it: an error, or rays whose hits are right and written as found.
pub fn npy_trace(data: &[u8]) {
    let Ok(mut rays) = npy::read_rays(&mut &*data) else { return };
    rays.truncate(32);
    let model = builtin::cube();
    let mesh = model.mesh().unwrap();
    Agreement { structures: vec![Structure::HYBRID.into()], ..Agreement::quick() }.assert(&mesh, &rays);
    let scene = Scene::build(&mesh, &Default::default()).unwrap();
    for mut answer in [Answer::closest(rays.len()), Answer::any(rays.len()), Answer::all()] {
        answer.ask(&scene, &rays);
        let mut file = Vec::new();
        answer.write(&mut file).unwrap();
        let rows: Vec<u8> = match &answer {
            Answer::Closest(hits) => cast_slice(hits).to_vec(),
            Answer::Any(hits) => cast_slice(hits).to_vec(),
            Answer::All(lists) => (0..rays.len() as u32)
                .flat_map(|ray| lists.of(ray as usize).iter().map(move |hit| (ray, hit)))
                .flat_map(|(ray, hit)| [bytes_of(&ray), bytes_of(hit)].concat())
                .collect(),
        };
        assert!(file.ends_with(&rows), "{rows:?} in {file:?}");
    }
}
