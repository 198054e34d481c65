/* Cuts a model or a mesh file by a plane, writes its pieces, then lets the body fall, cuts it while
   it moves, and undoes the cut.

   cc cut.c -I ../include -L ../../../target/release -lincise_c -o cut && ./cut [FILE] */
#include <incise.h>
#include <stdio.h>
#include <stdlib.h>

/* Stops with the text of the library if a call failed. */
static void check(incise_status status, const char *call) {
    if (status != INCISE_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", call, incise_last_error());
        exit(1);
    }
}
#define CHECK(call) check(call, #call)

static void slice(incise_mesh *mesh) {
    incise_cut_params params;
    CHECK(incise_cut_params_init(&params));
    params.level = 1 / 1.5;
    const double normal[3] = {0, 1, 0.2};
    incise_cut_result *result;
    CHECK(incise_mesh_cut_plane(mesh, normal, 0.05, &params, &result));
    incise_cut_report report;
    CHECK(incise_cut_result_report(result, &report));
    printf("%u triangles hit, %u in caps, %.2f ms\n", report.hits, report.cap_faces,
           1e3 * report.seconds);
    for (uint32_t i = 0; i < report.pieces; i++) {
        incise_mesh *piece;
        CHECK(incise_cut_result_piece(result, i, &piece));
        incise_mesh_counts counts;
        CHECK(incise_mesh_count(piece, &counts));
        incise_mesh_measures measures;
        CHECK(incise_mesh_measure(piece, &measures));
        float *vertices = malloc(3 * sizeof(float) * counts.vertices);
        CHECK(incise_mesh_vertices(piece, vertices, 3 * (size_t)counts.vertices));
        char name[32];
        snprintf(name, sizeof name, "piece_%u.obj", i);
        CHECK(incise_mesh_write(piece, name));
        printf("%s: %u triangles, volume %.6f m^3, first vertex %g %g %g\n", name, counts.faces,
               measures.volume, vertices[0], vertices[1], vertices[2]);
        free(vertices);
        CHECK(incise_mesh_free(piece));
    }
    CHECK(incise_cut_result_free(result));
}

static void simulate(incise_mesh *mesh) {
    incise_scene_params params;
    CHECK(incise_scene_params_init(&params));
    params.contacts = 1;
    incise_scene *scene;
    CHECK(incise_scene_new(&params, &scene));
    const incise_collider ground = {
        .kind = INCISE_COLLIDER_PLANE, .position = {0, -0.6f, 0}, .direction = {0, 1, 0}};
    CHECK(incise_scene_set_colliders(scene, &ground, 1));
    uint32_t body, blade;
    CHECK(incise_scene_add_body(scene, mesh, NULL, &body));
    const float before[6] = {-1, 0.05f, -1, -1, 0.05f, 1};
    const float after[6] = {1, 0.05f, -1, 1, 0.05f, 1};
    CHECK(incise_scene_add_blade(scene, before, &blade));
    CHECK(incise_scene_step(scene, NULL));
    CHECK(incise_scene_move_blade(scene, blade, after));
    incise_frame_stats stats;
    CHECK(incise_scene_step(scene, &stats));
    incise_body_counts counts;
    CHECK(incise_body_count(scene, body, &counts));
    printf("the frame made %u cut in %.2f ms: %u pieces\n", stats.cuts, 1e3 * stats.cut_seconds,
           counts.pieces);
    for (int frame = 0; frame < 30; frame++) CHECK(incise_scene_step(scene, NULL));
    float *positions = malloc(3 * sizeof(float) * counts.vertices);
    CHECK(incise_body_positions(scene, body, positions, 3 * (size_t)counts.vertices));
    CHECK(incise_scene_undo(scene, body));
    CHECK(incise_body_count(scene, body, &counts));
    printf("after the undo: %u piece\n", counts.pieces);
    free(positions);
    CHECK(incise_scene_free(scene));
}

int main(int argc, char **argv) {
    if (incise_abi_version() != INCISE_ABI_VERSION) {
        fprintf(stderr, "the library has another version than incise.h\n");
        return 1;
    }
    incise_mesh *mesh;
    if (argc > 1) {
        CHECK(incise_mesh_read(argv[1], &mesh));
    } else {
        CHECK(incise_mesh_model("Bunny", &mesh));
    }
    slice(mesh);
    simulate(mesh);
    CHECK(incise_mesh_free(mesh));
    return 0;
}
