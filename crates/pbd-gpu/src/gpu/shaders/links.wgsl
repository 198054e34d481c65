// Finds the body of a workgroup.

struct Work {
    body: u32,
    // Index of the first lane of the workgroup among all lanes of the body.
    first_lane: u32,
}

// Returns the index of a workgroup. Large dispatches have several rows, since a row is limited;
// groups beyond those of the last link have no work.
fn group_number(group: vec3u, groups: vec3u) -> u32 {
    return group.x + group.y * groups.x;
}

// Finds the last link of the pass that starts at or before the group. Links ascend from group 0.
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
