// Which body a workgroup works on.

struct Work {
    body: u32,
    // The number of the workgroup's first lane among all lanes that work on the body.
    first_lane: u32,
}

// A large dispatch has rows of workgroups, because a row is limited. Groups after those of the last
// link get numbers beyond its work.
fn group_number(group: vec3u, groups: vec3u) -> u32 {
    return group.x + group.y * groups.x;
}

// The last link of the pass that begins at or before the group. Links ascend and the first one begins
// at group 0.
fn find_work(group: u32) -> Work {
    var low = current.first_link;
    var high = current.first_link + current.links;
    while (high - low > 1u) {
        let middle = low + (high - low) / 2u;
        if (links[middle].first_group <= group) {
            low = middle;
        } else {
            high = middle;
        }
    }
    let link = links[low];
    return Work(link.body, (group - link.first_group) * WORKGROUP_SIZE);
}
