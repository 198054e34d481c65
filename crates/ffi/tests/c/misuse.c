/* Calls the interface with NULL, freed and foreign handles, wrong sizes and numbers that are not
   finite, and from several threads. Every call returns the right status with a text, and writes
   nothing. */
#include <incise.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

static void expect(incise_status found, incise_status expected, const char *word, const char *call,
                   int line) {
    const char *text = incise_last_error();
    if (found != expected || (found != INCISE_STATUS_OK) != (text[0] != 0) || !strstr(text, word)) {
        printf("line %d: %s is %d, not %d: '%s' without '%s'\n", line, call, found, expected, text,
               word);
        failures++;
    }
}
#define EXPECT(call, status, word) expect(call, INCISE_STATUS_##status, word, #call, __LINE__)
#define OK(call) EXPECT(call, OK, "")

static const float corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const uint32_t sides[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

static void meshes(void) {
    incise_mesh *mesh = NULL, *none = NULL;
    EXPECT(incise_mesh_new(NULL, 4, sides, 4, NULL, 0, &mesh), NULL_POINTER, "vertices");
    EXPECT(incise_mesh_new(corners, 4, NULL, 4, NULL, 0, &mesh), NULL_POINTER, "faces");
    EXPECT(incise_mesh_new(corners, 4, sides, 4, NULL, 4, &mesh), NULL_POINTER, "uv");
    EXPECT(incise_mesh_new(corners, 4, sides, 4, NULL, 0, NULL), NULL_POINTER, "out");
    EXPECT(incise_mesh_new(corners, 3, sides, 4, NULL, 0, &mesh), OUT_OF_RANGE, "faces[5] is 3");
    EXPECT(incise_mesh_new(corners, SIZE_MAX / 2, sides, 4, NULL, 0, &mesh), INVALID_ARGUMENT,
           "vertices");
    EXPECT(incise_mesh_new(corners, 4, sides, 4, corners, 5, &mesh), INVALID_ARGUMENT, "uv has 5");
    EXPECT(incise_mesh_new((const float *)((const char *)corners + 1), 3, sides, 0, NULL, 0, &mesh),
           INVALID_ARGUMENT, "aligned");
    float nan[12];
    memcpy(nan, corners, sizeof nan);
    nan[7] = NAN;
    EXPECT(incise_mesh_new(nan, 4, sides, 4, NULL, 0, &mesh), INVALID_ARGUMENT, "vertices[7]");
    const uint32_t fan[9] = {0, 1, 2, 0, 1, 3, 0, 1, 2};
    EXPECT(incise_mesh_new(corners, 4, fan, 3, NULL, 0, &mesh), INVALID_MESH, "");
    EXPECT(incise_mesh_repair(corners, 4, sides, 0, NULL, 0, &mesh), INVALID_MESH, "");
    EXPECT(incise_mesh_model(NULL, &mesh), NULL_POINTER, "name");
    EXPECT(incise_mesh_model("Teapot", &mesh), INVALID_ARGUMENT, "Bunny");
    EXPECT(incise_mesh_model("\xff", &mesh), INVALID_ARGUMENT, "UTF-8");
    EXPECT(incise_mesh_read("no such file.obj", &mesh), FILE, "no such file.obj");
    if (mesh != NULL) failures++, printf("a failed call wrote its handle\n");

    OK(incise_mesh_new(corners, 4, sides, 4, corners, 4, &mesh));
    incise_mesh_counts counts;
    OK(incise_mesh_count(mesh, &counts));
    if (counts.vertices != 4 || counts.faces != 4 || counts.uv != 12 || counts.boundary_edges != 0)
        failures++, printf("counts of a tetrahedron\n");
    incise_mesh_measures measures;
    OK(incise_mesh_measure(mesh, &measures));
    if (fabs(measures.volume - 1 / 6.0) > 1e-7) failures++, printf("volume %g\n", measures.volume);
    float short_buffer[12];
    memset(short_buffer, 7, sizeof short_buffer);
    float untouched[12];
    memcpy(untouched, short_buffer, sizeof untouched);
    EXPECT(incise_mesh_vertices(mesh, short_buffer, 11), BUFFER_TOO_SMALL, "needs 12");
    if (memcmp(short_buffer, untouched, sizeof untouched)) failures++, printf("a short copy\n");
    EXPECT(incise_mesh_vertices(mesh, NULL, 12), NULL_POINTER, "out");
    EXPECT(incise_mesh_count(mesh, NULL), NULL_POINTER, "out");
    EXPECT(incise_mesh_write(mesh, "mesh.xyz"), FILE, "obj");
    EXPECT(incise_mesh_write(mesh, "/no/such/folder/mesh.obj"), FILE, "");
    incise_fill_params fill;
    OK(incise_fill_params_init(&fill));
    fill.level = NAN;
    EXPECT(incise_mesh_fill(mesh, &fill, NULL), INVALID_ARGUMENT, "level");
    EXPECT(incise_mesh_count((incise_mesh *)12345678, &counts), INVALID_HANDLE, "never made");
    EXPECT(incise_mesh_count(none, &counts), NULL_POINTER, "mesh");
    EXPECT(incise_scene_free((incise_scene *)mesh), INVALID_HANDLE, "of a mesh");
    OK(incise_mesh_free(mesh));
    EXPECT(incise_mesh_free(mesh), INVALID_HANDLE, "freed");
    EXPECT(incise_mesh_count(mesh, &counts), INVALID_HANDLE, "freed");
    OK(incise_mesh_free(NULL));

    /* An open mesh is checked and filled. */
    OK(incise_mesh_new(corners, 4, sides, 3, NULL, 0, &mesh));
    incise_fill_report filled;
    OK(incise_mesh_fill(mesh, NULL, &filled));
    OK(incise_mesh_count(mesh, &counts));
    if (filled.filled != 1 || counts.boundary_edges != 0) failures++, printf("fill\n");
    OK(incise_mesh_free(mesh));
    incise_mesh_report report;
    char text[200];
    size_t length = 0;
    EXPECT(incise_check(corners, 4, sides, 3, NULL, text, 0, &length), NULL_POINTER, "out");
    OK(incise_check(corners, 4, sides, 3, &report, text, sizeof text, &length));
    if (report.open_edges != 3 || report.closed != 0) failures++, printf("check\n");
    EXPECT(incise_check_file("no.ply", &report, text, 0, NULL), FILE, "no.ply");
}

static void cuts(void) {
    incise_mesh *mesh, *piece;
    incise_cut_result *result = NULL;
    OK(incise_mesh_model("Sphere768", &mesh));
    const double up[3] = {0, 1, 0.1}, zero[3] = {0, 0, 0}, nan[3] = {0, NAN, 0};
    EXPECT(incise_mesh_cut_plane(mesh, NULL, 0, NULL, &result), NULL_POINTER, "normal");
    EXPECT(incise_mesh_cut_plane(mesh, zero, 0, NULL, &result), REFUSED, "no area");
    EXPECT(incise_mesh_cut_plane(mesh, nan, 0, NULL, &result), INVALID_ARGUMENT, "finite");
    EXPECT(incise_mesh_cut_plane(mesh, up, INFINITY, NULL, &result), INVALID_ARGUMENT, "finite");
    incise_cut_params params;
    OK(incise_cut_params_init(&params));
    params.level = -1;
    EXPECT(incise_mesh_cut_plane(mesh, up, 0, &params, &result), INVALID_ARGUMENT, "level");
    params.level = 1, params.snap = 0.7;
    EXPECT(incise_mesh_cut_plane(mesh, up, 0, &params, &result), INVALID_ARGUMENT, "snap");
    params.snap = 0.1, params.remesh = NAN;
    EXPECT(incise_mesh_cut_plane(mesh, up, 0, &params, &result), INVALID_ARGUMENT, "remesh");
    params.remesh = 0, params.grading = -1;
    EXPECT(incise_mesh_cut_plane(mesh, up, 0, &params, &result), INVALID_ARGUMENT, "grading");
    params.grading = 0, params.cap_uv_scale = -1;
    EXPECT(incise_mesh_cut_plane(mesh, up, 0, &params, &result), INVALID_ARGUMENT, "cap_uv_scale");
    params.cap_uv_scale = 1, params.caps = 9;
    EXPECT(incise_mesh_cut_plane(mesh, up, 0, &params, &result), INVALID_ARGUMENT, "caps is 9");
    float poses[12] = {0, 1, -1, 0, 1, 1, 0, 0, -1, 0, 0, 1};
    EXPECT(incise_mesh_cut_path(mesh, poses, 2, 1, NULL, &result), INVALID_ARGUMENT, "at least 2");
    EXPECT(incise_mesh_cut_path(mesh, poses, SIZE_MAX, 2, NULL, &result), INVALID_ARGUMENT, "");
    EXPECT(incise_mesh_cut_path(mesh, NULL, 2, 2, NULL, &result), NULL_POINTER, "poses");
    poses[3] = INFINITY;
    EXPECT(incise_mesh_cut_path(mesh, poses, 2, 2, NULL, &result), INVALID_ARGUMENT, "poses[3]");
    poses[3] = 0;
    if (result != NULL) failures++, printf("a failed cut wrote its handle\n");
    incise_cut_report report;
    OK(incise_mesh_cut_path(mesh, poses, 2, 2, NULL, &result));
    OK(incise_cut_result_report(result, &report));
    if (report.tip_vertices == 0 || report.pieces != 1) failures++, printf("an incision\n");
    OK(incise_cut_result_free(result));
    OK(incise_mesh_cut_plane(mesh, up, 9, NULL, &result));
    OK(incise_cut_result_report(result, &report));
    if (report.hits != 0 || report.pieces != 1) failures++, printf("a miss\n");
    OK(incise_cut_result_free(result));
    OK(incise_mesh_cut_plane(mesh, up, 0, NULL, &result));
    OK(incise_mesh_free(mesh));
    EXPECT(incise_cut_result_piece(result, 2, &piece), OUT_OF_RANGE, "2 pieces");
    uint32_t ids[1];
    float short_weights[1];
    EXPECT(incise_cut_result_vertex_ids(result, ids, 1), BUFFER_TOO_SMALL, "room for 1");
    EXPECT(incise_cut_result_origins(result, NULL, 0, NULL, 0), NULL_POINTER, "weights");
    EXPECT(incise_cut_result_origins(result, ids, 1, short_weights, 1), BUFFER_TOO_SMALL,
           "weights");
    OK(incise_cut_result_piece(result, 1, &piece));
    OK(incise_cut_result_free(result));
    EXPECT(incise_cut_result_report(result, &report), INVALID_HANDLE, "freed");
    OK(incise_mesh_free(piece));
}

/* Saves a scene, and steps it and the loaded one to the same bits. */
static void saved(incise_scene *scene, uint32_t body) {
    size_t length = 0;
    OK(incise_scene_save(scene, NULL, 0, &length));
    uint8_t *bytes = malloc(length);
    EXPECT(incise_scene_save(scene, bytes, length - 1, NULL), BUFFER_TOO_SMALL, "needs");
    OK(incise_scene_save(scene, bytes, length, NULL));
    incise_scene *loaded = NULL;
    EXPECT(incise_scene_load(bytes, length / 2, &loaded), FILE, "");
    EXPECT(incise_scene_load(NULL, length, &loaded), NULL_POINTER, "bytes");
    OK(incise_scene_load(bytes, length, &loaded));
    free(bytes);
    incise_body_counts counts;
    OK(incise_body_count(scene, body, &counts));
    float *positions[2];
    for (int i = 0; i < 2; i++) {
        incise_scene *of = i ? loaded : scene;
        positions[i] = malloc(counts.vertices * 3 * sizeof(float));
        OK(incise_scene_step(of, NULL));
        OK(incise_body_positions(of, body, positions[i], 3 * (size_t)counts.vertices));
    }
    if (memcmp(positions[0], positions[1], counts.vertices * 3 * sizeof(float)) != 0)
        failures++, printf("a loaded scene has other bits\n");
    free(positions[0]);
    free(positions[1]);
    OK(incise_scene_free(loaded));
}

/* Moves a blade along z, and compares the state of its incision in a ball. */
static void incise_to(incise_scene *scene, uint32_t blade, uint32_t body, float x, float y,
                      incise_incision_state state) {
    const float edge[6] = {x, y, -2, x, y, 2};
    incise_incision incision;
    OK(incise_scene_move_blade(scene, blade, edge));
    OK(incise_scene_step(scene, NULL));
    OK(incise_scene_incision(scene, blade, body, &incision));
    if (incision.state != state || incision.refused_steps != 0)
        failures++, printf("state %d of an incision, not %d\n", incision.state, state);
}

static void incisions(void) {
    incise_scene *scene;
    incise_mesh *mesh;
    uint32_t blade, body;
    incise_incision incision;
    const float edge[6] = {-2, 0, -2, -2, 0, 2}, above[6] = {-2, 0.2f, -2, -2, 0.2f, 2};
    OK(incise_scene_new(NULL, &scene));
    OK(incise_scene_set(scene, "gravity", "0,0,0"));
    OK(incise_mesh_model("Sphere768", &mesh));
    OK(incise_scene_add_body(scene, mesh, NULL, &body));
    OK(incise_mesh_free(mesh));
    OK(incise_scene_add_blade(scene, edge, &blade));
    EXPECT(incise_scene_incision(scene, blade, body, NULL), NULL_POINTER, "out");
    EXPECT(incise_scene_incision(scene, blade + 1, body, &incision), OUT_OF_RANGE, "blade 1");
    EXPECT(incise_scene_incision(scene, blade, body + 1, &incision), OUT_OF_RANGE, "body 1");
    OK(incise_scene_incision(scene, blade, body, &incision));
    if (incision.state != INCISE_INCISION_STATE_OUTSIDE) failures++, printf("no incision\n");
    incise_to(scene, blade, body, 0, 0, INCISE_INCISION_STATE_INSIDE);
    incise_to(scene, blade, body, 2, 0, INCISE_INCISION_STATE_FINISHED);
    OK(incise_scene_teleport_blade(scene, blade, above));
    OK(incise_scene_incision(scene, blade, body, &incision));
    if (incision.state != INCISE_INCISION_STATE_OUTSIDE) failures++, printf("a teleport\n");
    incise_to(scene, blade, body, 0, 0.2f, INCISE_INCISION_STATE_INSIDE);
    incise_to(scene, blade, body, -1.5f, 1.2f, INCISE_INCISION_STATE_ABANDONED);
    OK(incise_scene_free(scene));
}

static void scenes(void) {
    incise_scene_params params;
    OK(incise_scene_params_init(&params));
    incise_scene *scene = NULL;
    params.sleep = 3;
    EXPECT(incise_scene_new(&params, &scene), INVALID_ARGUMENT, "sleep is 3");
    params.sleep = 1, params.backend = 9;
    EXPECT(incise_scene_new(&params, &scene), INVALID_ARGUMENT, "backend is 9");
    params.backend = INCISE_BACKEND_GPU;
    EXPECT(incise_scene_new(&params, &scene), SIMULATION, "feature gpu");
    params.backend = INCISE_BACKEND_CPU;
    OK(incise_scene_new(&params, &scene));
    incise_mesh *mesh;
    OK(incise_mesh_model("Sphere80", &mesh));
    uint32_t body = 9, blade = 9, undos;
    incise_material material;
    EXPECT(incise_material_init(8, &material), INVALID_ARGUMENT, "preset");
    OK(incise_material_init(INCISE_MATERIAL_CLOTH, &material));
    material.density = -1;
    EXPECT(incise_scene_add_body(scene, mesh, &material, &body), SIMULATION, "density");
    EXPECT(incise_scene_add_body(scene, NULL, NULL, &body), NULL_POINTER, "mesh");
    OK(incise_scene_add_body(scene, mesh, NULL, &body));
    OK(incise_mesh_free(mesh));
    EXPECT(incise_scene_add_body(scene, mesh, NULL, &body), INVALID_HANDLE, "freed");
    incise_collider collider;
    memset(&collider, 0, sizeof collider);
    collider.kind = 7;
    EXPECT(incise_scene_set_colliders(scene, &collider, 1), INVALID_ARGUMENT, "kind");
    EXPECT(incise_scene_set_colliders(scene, NULL, 1), NULL_POINTER, "colliders");
    const float bad_radii[4] = {NAN, -1, 0, INFINITY};
    for (int i = 0; i < 4; i++) {
        incise_collider shapes[2];
        memset(shapes, 0, sizeof shapes);
        shapes[0].kind = shapes[1].kind = INCISE_COLLIDER_SPHERE;
        shapes[0].radius = 0.1f, shapes[0].position[1] = -9, shapes[1].radius = bad_radii[i];
        EXPECT(incise_scene_set_colliders(scene, shapes, 2), INVALID_ARGUMENT, "collider 1");
    }
    OK(incise_scene_step(scene, NULL));
    double origin[3] = {1, 1, 1};
    OK(incise_scene_origin(scene, origin));
    if (origin[0] != 0 || origin[2] != 0) failures++, printf("the origin of a scene\n");
    EXPECT(incise_scene_origin(scene, NULL), NULL_POINTER, "out");
    float edge[6] = {-2, 0, -2, -2, 0, 2};
    EXPECT(incise_scene_add_blade(scene, NULL, &blade), NULL_POINTER, "edge");
    OK(incise_scene_add_blade(scene, edge, &blade));
    edge[4] = NAN;
    EXPECT(incise_scene_move_blade(scene, blade, edge), INVALID_ARGUMENT, "edge[4]");
    edge[4] = 0;
    EXPECT(incise_scene_move_blade(scene, 5, edge), OUT_OF_RANGE, "blade 5");
    EXPECT(incise_scene_teleport_blade(scene, blade, NULL), NULL_POINTER, "edge");
    EXPECT(incise_scene_undo(scene, body), REFUSED, "no cut");
    EXPECT(incise_scene_undo_count(scene, 4, &undos), OUT_OF_RANGE, "body 4");
    EXPECT(incise_body_pin(scene, body, 100000), OUT_OF_RANGE, "vertex 100000");
    EXPECT(incise_body_unpin(scene, body, 0), OUT_OF_RANGE, "pinned");
    const double nan[3] = {NAN, 0, 0}, down[3] = {0, -1, 0};
    incise_ray_hit hit;
    EXPECT(incise_body_cast_ray(scene, body, nan, down, &hit), INVALID_ARGUMENT, "finite");
    float positions[3];
    EXPECT(incise_body_positions(scene, body, positions, 3), BUFFER_TOO_SMALL, "needs");
    EXPECT(incise_body_positions(scene, 1, positions, 3), OUT_OF_RANGE, "body 1");
    const incise_scene_params valid = params;
    params.dt = NAN;
    EXPECT(incise_scene_set_params(scene, &params), INVALID_ARGUMENT, "dt is NaN");
    params = valid, params.gravity[1] = NAN;
    EXPECT(incise_scene_set_params(scene, &params), INVALID_ARGUMENT, "gravity");
    params = valid, params.cut.grading = NAN;
    EXPECT(incise_scene_set_params(scene, &params), INVALID_ARGUMENT, "grading");
    params = valid, params.substep = -1;
    EXPECT(incise_scene_set_params(scene, &params), INVALID_ARGUMENT, "substep");
    OK(incise_scene_set_params(scene, &valid));
    OK(incise_scene_step(scene, NULL));
    saved(scene, body);
    OK(incise_material_init(INCISE_MATERIAL_SOFT_BODY, &material));
    material.friction = 0.9f;
    OK(incise_body_set_material(scene, body, &material));
    EXPECT(incise_body_set_material(scene, body, NULL), NULL_POINTER, "material");
    material.friction = NAN;
    EXPECT(incise_body_set_material(scene, body, &material), SIMULATION, "friction");
    material.friction = 0, material.density = 2;
    EXPECT(incise_body_set_material(scene, body, &material), SIMULATION, "density");
    OK(incise_scene_remove_body(scene, body));
    EXPECT(incise_scene_remove_body(scene, body), OUT_OF_RANGE, "body");
    OK(incise_scene_free(scene));
    EXPECT(incise_scene_step(scene, NULL), INVALID_HANDLE, "freed");
}

/* Cuts one mesh in several threads; each has its own error text. */
static void *cut_in_thread(void *mesh) {
    const double up[3] = {0, 1, 0.1}, zero[3] = {0, 0, 0};
    for (int i = 0; i < 20; i++) {
        incise_cut_result *result;
        if (incise_mesh_cut_plane(mesh, zero, 0, NULL, &result) != INCISE_STATUS_REFUSED ||
            !strstr(incise_last_error(), "no area"))
            return "a refused cut in a thread";
        if (incise_mesh_model("Teapot", NULL) == INCISE_STATUS_OK) return "no place for a handle";
        if (incise_mesh_cut_plane(mesh, up, 0.01 * i, NULL, &result) != INCISE_STATUS_OK ||
            incise_last_error()[0] != 0)
            return "a cut in a thread";
        if (incise_cut_result_free(result) != INCISE_STATUS_OK) return "a free in a thread";
    }
    return NULL;
}

static void threads(void) {
    incise_mesh *mesh;
    OK(incise_mesh_model("Sphere80", &mesh));
    pthread_t workers[4];
    for (int i = 0; i < 4; i++)
        if (pthread_create(&workers[i], NULL, cut_in_thread, mesh)) exit(1);
    for (int i = 0; i < 4; i++) {
        void *text = NULL;
        pthread_join(workers[i], &text);
        if (text != NULL) failures++, printf("%s\n", (const char *)text);
    }
    OK(incise_mesh_free(mesh));
}

int main(void) {
    threads();
    meshes();
    cuts();
    incisions();
    scenes();
    if (incise_live_handles() != 0) failures++, printf("handles are left\n");
    printf("%d failures\n", failures);
    return failures != 0;
}
