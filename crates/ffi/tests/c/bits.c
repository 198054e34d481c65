/* Prints the list of cuts at the path given (tests/seeded_cuts.txt) with its own results. */
#include <incise.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void check(incise_status status, const char *call) {
    if (status != INCISE_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", call, incise_last_error());
        exit(1);
    }
}
#define CHECK(call) check(call, #call)

/* Returns the CRC-32 of bytes of a little-endian machine that follow those of `crc`. */
static uint32_t crc32(uint32_t crc, const void *data, size_t size) {
    const unsigned char *bytes = data;
    crc = ~crc;
    for (size_t i = 0; i < 8 * size; i++) {
        if (i % 8 == 0) crc ^= bytes[i / 8];
        crc = (crc >> 1) ^ (0xedb88320u & (0u - (crc & 1u)));
    }
    return ~crc;
}

static void *allocate(size_t size) {
    void *memory = malloc(size);
    if (!memory) exit(1);
    return memory;
}

/* The vertices and triangles of a mesh. */
typedef struct {
    incise_mesh_counts n;
    float *vertices;
    uint32_t *faces;
} arrays;

/* Returns the arrays of a mesh and frees it. */
static arrays arrays_of(incise_mesh *mesh) {
    arrays a;
    CHECK(incise_mesh_count(mesh, &a.n));
    a.vertices = allocate(12 * (size_t)a.n.vertices);
    a.faces = allocate(12 * (size_t)a.n.faces);
    CHECK(incise_mesh_vertices(mesh, a.vertices, 3 * (size_t)a.n.vertices));
    CHECK(incise_mesh_faces(mesh, a.faces, 3 * (size_t)a.n.faces));
    CHECK(incise_mesh_free(mesh));
    return a;
}

/* Returns a built-in model that went through arrays of this program. */
static incise_mesh *model(const char *name) {
    incise_mesh *mesh;
    CHECK(incise_mesh_model(name, &mesh));
    arrays a = arrays_of(mesh);
    CHECK(incise_mesh_new(a.vertices, a.n.vertices, a.faces, a.n.faces, NULL, 0, &mesh));
    free(a.vertices), free(a.faces);
    return mesh;
}

/* Hashes the arrays of a mesh and frees it. */
static uint32_t hash(uint32_t crc, incise_mesh *mesh) {
    arrays a = arrays_of(mesh);
    crc = crc32(crc, a.vertices, 12 * (size_t)a.n.vertices);
    crc = crc32(crc, a.faces, 12 * (size_t)a.n.faces);
    free(a.vertices), free(a.faces);
    return crc;
}

/* Prints the number of pieces and their hash, and frees the result. */
static void print(incise_cut_result *result) {
    incise_cut_report report;
    CHECK(incise_cut_result_report(result, &report));
    uint32_t crc = 0;
    for (uint32_t i = 0; i < report.pieces; i++) {
        incise_mesh *piece;
        CHECK(incise_cut_result_piece(result, i, &piece));
        crc = hash(crc, piece);
    }
    printf(" %u %08x\n", report.pieces, crc);
    CHECK(incise_cut_result_free(result));
}

static incise_status cut(incise_mesh *mesh, const char *method, const char *level,
                         const double *numbers, incise_cut_result **result) {
    incise_cut_params params;
    CHECK(incise_cut_params_init(&params));
    if (strcmp(level, "2x-finer") == 0) params.level = 0.5;
    if (strcmp(method, "path") != 0) {
        return incise_mesh_cut_plane(mesh, numbers, numbers[3], &params, result);
    }
    double x = numbers[0], y = numbers[1], z = numbers[2], d = numbers[3];
    const double heights[3] = {y, 0.5 * (y + d), d};
    float poses[18];
    for (int k = 0; k < 3; k++) {
        const double pose[6] = {x, heights[k], z - 1, x, heights[k], z + 1};
        for (int j = 0; j < 6; j++) poses[6 * k + j] = (float)pose[j];
    }
    return incise_mesh_cut_path(mesh, poses, 3, 2, &params, result);
}

/* Prints pieces and hash of a body that falls on a floor and is cut in frames 10 and 11. */
static void print_scene(incise_mesh *mesh, const double *numbers) {
    incise_scene_params params;
    CHECK(incise_scene_params_init(&params));
    params.contacts = params.threads = 1;
    incise_scene *scene;
    uint32_t body, blade;
    CHECK(incise_scene_new(&params, &scene));
    const incise_collider ground = {
        .kind = INCISE_COLLIDER_PLANE,
        .position = {0, (float)numbers[3], 0},
        .direction = {0, 1, 0}};
    CHECK(incise_scene_set_colliders(scene, &ground, 1));
    CHECK(incise_scene_add_body(scene, mesh, NULL, &body));
    float x = (float)numbers[0], y = (float)numbers[1], z = (float)numbers[2];
    float edge[6] = {-x, y, -z, -x, y, z};
    CHECK(incise_scene_add_blade(scene, edge, &blade));
    for (int frame = 0; frame < 90; frame++) {
        if (frame == 10 || frame == 11) {
            edge[0] = edge[3] = frame == 10 ? 0 : x;
            CHECK(incise_scene_move_blade(scene, blade, edge));
        }
        CHECK(incise_scene_step(scene, NULL));
    }
    incise_mesh *end;
    incise_mesh_counts n;
    CHECK(incise_body_mesh(scene, body, &end));
    CHECK(incise_mesh_count(end, &n));
    printf(" %u %08x\n", n.pieces, hash(0, end));
    CHECK(incise_scene_free(scene));
}

int main(int count, char **arguments) {
    FILE *list = count == 2 ? fopen(arguments[1], "r") : NULL;
    if (!list) return 2;
    char line[256], name[32], method[32], level[32];
    while (fgets(line, sizeof line, list)) {
        double numbers[4];
        int end = 0;
        sscanf(line, "%31s %31s %31s %lf %lf %lf %lf%n", name, method, level, &numbers[0],
               &numbers[1], &numbers[2], &numbers[3], &end);
        if (end == 0) return 2;
        printf("%.*s", end, line);
        incise_mesh *mesh = model(name);
        if (strcmp(method, "scene") == 0) {
            print_scene(mesh, numbers);
        } else {
            incise_cut_result *result;
            incise_status status = cut(mesh, method, level, numbers, &result);
            if (status == INCISE_STATUS_REFUSED) {
                puts(" refused");
            } else {
                check(status, "cut");
                print(result);
            }
        }
        CHECK(incise_mesh_free(mesh));
    }
    fclose(list);
    return incise_live_handles() == 0 ? 0 : 1;
}
