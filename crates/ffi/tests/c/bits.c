/* Prints a line for each of 100 seeded cuts, like examples/cut_bits.rs, for a comparison. */
#include <incise.h>
#include <stdio.h>
#include <stdlib.h>

static void check(incise_status status, const char *call) {
    if (status != INCISE_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", call, incise_last_error());
        exit(1);
    }
}
#define CHECK(call) check(call, #call)

static uint64_t state = 20261125;

/* Returns a number from -1 to 1 with 24 bits. */
static double draw(void) {
    state = state * 6364136223846793005u + 1;
    return (double)(state >> 40) / 8388608.0 - 1.0;
}

/* The hash FNV-1a of bytes of a little-endian machine. */
static uint64_t hash(uint64_t value, const void *data, size_t size) {
    const unsigned char *bytes = data;
    for (size_t i = 0; i < size; i++) value = (value ^ bytes[i]) * 0x100000001b3u;
    return value;
}

static void *allocate(size_t count, size_t size) {
    void *memory = calloc(count + 1, size);
    if (!memory) exit(1);
    return memory;
}

/* Copies a mesh through arrays of this program. */
static incise_mesh *copied(incise_mesh *mesh) {
    incise_mesh_counts n;
    CHECK(incise_mesh_count(mesh, &n));
    float *vertices = allocate(3 * n.vertices, 4), *uv = allocate(2 * n.uv, 4);
    uint32_t *faces = allocate(3 * n.faces, 4);
    CHECK(incise_mesh_vertices(mesh, vertices, 3 * n.vertices));
    CHECK(incise_mesh_faces(mesh, faces, 3 * n.faces));
    CHECK(incise_mesh_uv(mesh, uv, 2 * n.uv));
    incise_mesh *copy;
    CHECK(incise_mesh_new(vertices, n.vertices, faces, n.faces, uv, n.uv, &copy));
    free(vertices), free(faces), free(uv);
    return copy;
}

static void print(int i, incise_cut_result *result) {
    incise_cut_report report;
    CHECK(incise_cut_result_report(result, &report));
    incise_mesh *mesh;
    CHECK(incise_cut_result_mesh(result, &mesh));
    incise_mesh_counts n;
    CHECK(incise_mesh_count(mesh, &n));
    float *vertices = allocate(3 * n.vertices, 4), *uv = allocate(2 * n.uv, 4);
    uint32_t *faces = allocate(3 * n.faces, 4), *pieces = allocate(n.faces, 4);
    unsigned char *caps = allocate(n.faces, 1);
    CHECK(incise_mesh_vertices(mesh, vertices, 3 * n.vertices));
    CHECK(incise_mesh_faces(mesh, faces, 3 * n.faces));
    CHECK(incise_mesh_uv(mesh, uv, 2 * n.uv));
    CHECK(incise_cut_result_face_pieces(result, pieces, n.faces));
    CHECK(incise_cut_result_caps(result, caps, n.faces));
    uint64_t value = 0xcbf29ce484222325u;
    value = hash(value, vertices, 12 * (size_t)n.vertices);
    value = hash(value, faces, 12 * (size_t)n.faces);
    value = hash(value, uv, 8 * (size_t)n.uv);
    value = hash(value, pieces, 4 * (size_t)n.faces);
    for (uint32_t t = 0; t < n.faces; t++) {
        uint32_t cap = caps[t];
        value = hash(value, &cap, 4);
    }
    printf("%d %u %u %016llx\n", i, report.pieces, report.hits, (unsigned long long)value);
    free(vertices), free(uv), free(faces), free(pieces), free(caps);
    CHECK(incise_mesh_free(mesh));
}

int main(void) {
    static const double levels[5] = {2, 1.5, 1, 1 / 1.5, 0.5};
    incise_mesh *model;
    CHECK(incise_mesh_model("bunny", &model));
    incise_mesh *mesh = copied(model);
    CHECK(incise_mesh_free(model));
    for (int i = 0; i < 100; i++) {
        incise_cut_params params;
        CHECK(incise_cut_params_init(&params));
        params.level = levels[i % 5];
        incise_cut_result *result;
        incise_status status;
        if (i % 10 == 9) {
            double x = 0.1 * draw(), z = 0.1 * draw(), depth = 0.2 * draw();
            const double heights[3] = {0.7, 0.2, depth};
            float poses[18];
            for (int k = 0; k < 3; k++) {
                float pose[6] = {x, heights[k], z - 1, x, heights[k], z + 1};
                for (int j = 0; j < 6; j++) poses[6 * k + j] = pose[j];
            }
            status = incise_mesh_cut_path(mesh, poses, 3, 2, &params, &result);
        } else {
            double normal[3];
            for (int k = 0; k < 3; k++) normal[k] = draw();
            params.method = i % 4 == 3 ? INCISE_METHOD_PAPER : INCISE_METHOD_EXACT;
            status = incise_mesh_cut_plane(mesh, normal, 0.2 * draw(), &params, &result);
        }
        if (status == INCISE_STATUS_REFUSED) {
            printf("%d refused\n", i);
            continue;
        }
        check(status, "cut");
        print(i, result);
        CHECK(incise_cut_result_free(result));
    }
    CHECK(incise_mesh_free(mesh));
    return incise_live_handles() == 0 ? 0 : 1;
}
