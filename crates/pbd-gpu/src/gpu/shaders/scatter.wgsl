// Writes single words. An edit touches words scattered over colors and vertices; one upload of
// indices and values costs less than a copy for each word.

struct Edits {
    count: u32,
    // Index and value of each edit.
    words: array<u32>,
}

@group(0) @binding(0) var<storage, read> edits: Edits;
@group(0) @binding(1) var<storage, read_write> words: array<u32>;

@compute @workgroup_size(64)
fn scatter(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.x + group.y * groups.x) * 64u + lane;
    if i < edits.count {
        words[edits.words[2u * i]] = edits.words[2u * i + 1u];
    }
}
