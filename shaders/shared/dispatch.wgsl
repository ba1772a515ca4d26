// One invocation per item of a dense array. Long arrays spill into rows of workgroups, because a dispatch may not exceed
// 65,535 workgroups along one axis.
const WORKGROUP: u32 = 64u;

fn item_index(workgroup: vec3u, workgroups: vec3u, local: u32) -> u32 {
    return (workgroup.y * workgroups.x + workgroup.x) * WORKGROUP + local;
}
