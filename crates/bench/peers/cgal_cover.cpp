// Covers the sections that `incise-bench refine --rims DIR` wrote with CGAL. See README.md.
//
//   cgal_cover hole|mesh RIMS RESULT.json [factor] [runs]

#include "sections.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version.h>

#include <chrono>
#include <iterator>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Blocks = CGAL::Triangulation_data_structure_2<CGAL::Delaunay_mesh_vertex_base_2<Kernel>,
                                                    CGAL::Delaunay_mesh_face_base_2<Kernel>>;
using Plane = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Blocks>;
using Clock = std::chrono::steady_clock;

static double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

// Holes of a surface have a surface around them: a wall for each loop, as high as edges are to be long.
static Surface walls(const Section& section) {
  Surface surface;
  std::vector<Surface::Vertex_index> above, below;
  for (auto [x, y] : section.points) above.push_back(surface.add_vertex({x, y, 0}));
  for (auto [x, y] : section.points) below.push_back(surface.add_vertex({x, y, -section.target}));
  for (const auto& loop : section.loops)
    for (size_t i = 0; i < loop.size(); ++i) {
      int a = loop[i], b = loop[(i + 1) % loop.size()];
      surface.add_face(above[b], above[a], below[a]);
      surface.add_face(above[b], below[a], below[b]);
    }
  return surface;
}

// A loop that runs clockwise lies within another: no hole of its own.
static bool is_nested(const Section& section) {
  return std::any_of(section.loops.begin(), section.loops.end(), [&](const std::vector<int>& loop) {
    double area = 0;
    for (size_t i = 0; i < loop.size(); ++i) {
      auto [ax, ay] = section.points[loop[i]];
      auto [bx, by] = section.points[loop[(i + 1) % loop.size()]];
      area += ax * by - ay * bx;
    }
    return area < 0;
  });
}

// Fills one hole after the other and refines.
static bool fill(const Section& section, double factor, double& ms, Cover& cover) {
  namespace PMP = CGAL::Polygon_mesh_processing;
  namespace parameters = PMP::parameters;
  Surface surface = walls(section);
  std::vector<Surface::Face_index> faces;
  std::vector<Surface::Vertex_index> inner;
  bool filled = true;
  auto begin = Clock::now();
  for (const auto& loop : section.loops) {
    auto edge = surface.halfedge(Surface::Vertex_index(loop[0]), Surface::Vertex_index(loop[1]));
    size_t before = faces.size();
    PMP::triangulate_and_refine_hole(
        surface, edge, std::back_inserter(faces), std::back_inserter(inner),
        parameters::density_control_factor(factor).use_2d_constrained_delaunay_triangulation(true));
    filled &= faces.size() > before;
  }
  ms = ms_since(begin);
  // Inner points come after the wall's.
  auto index = [&](Surface::Vertex_index v) {
    int n = int(section.points.size()), i = int(v);
    return i < n ? i : i - n;
  };
  cover = {section.points, {}};
  for (auto v : surface.vertices())
    if (size_t(v) >= 2 * section.points.size())
      cover.points.push_back({surface.point(v).x(), surface.point(v).y()});
  for (auto f : faces) {
    Corners corners;
    auto corner = corners.begin();
    for (auto v : surface.vertices_around_face(surface.halfedge(f))) *corner++ = index(v);
    cover.triangles.push_back(corners);
  }
  return filled;
}

// What lies within an odd number of loops is meshed.
static void mark(Plane& plane) {
  for (auto f : plane.all_face_handles()) f->set_in_domain(false);
  std::map<Plane::Face_handle, int> depths;
  std::vector<Plane::Face_handle> next{plane.infinite_face()};
  depths[next[0]] = 0;
  for (int depth = 0; !next.empty(); ++depth) {
    std::vector<Plane::Face_handle> beyond;
    while (!next.empty()) {
      auto f = next.back();
      next.pop_back();
      f->set_in_domain(depth % 2 == 1);
      for (int i = 0; i < 3; ++i) {
        auto other = f->neighbor(i);
        if (depths.count(other)) continue;
        if (f->is_constrained(i)) {
          beyond.push_back(other);
        } else {
          depths[other] = depth;
          next.push_back(other);
        }
      }
    }
    for (auto f : beyond)
      if (depths.emplace(f, depth + 1).second) next.push_back(f);
  }
}

// Meshes the plane between the loops; rim edges are split where that makes better triangles.
static bool mesh(const Section& section, double factor, double& ms, Cover& cover) {
  auto begin = Clock::now();
  Plane plane;
  for (const auto& loop : section.loops) {
    std::vector<Kernel::Point_2> points;
    for (int p : loop) points.emplace_back(section.points[p][0], section.points[p][1]);
    plane.insert_constraint(points.begin(), points.end(), true);
  }
  mark(plane);
  CGAL::refine_Delaunay_mesh_2(plane, CGAL::Delaunay_mesh_size_criteria_2<Plane>(0.125, factor * section.target), true);
  ms = ms_since(begin);
  cover = {};
  std::map<Plane::Vertex_handle, int> index;
  for (auto v : plane.finite_vertex_handles()) {
    index[v] = int(cover.points.size());
    cover.points.push_back({v->point().x(), v->point().y()});
  }
  for (auto f : plane.finite_face_handles())
    if (f->is_in_domain()) cover.triangles.push_back({index[f->vertex(0)], index[f->vertex(1)], index[f->vertex(2)]});
  return !cover.triangles.empty();
}

int main(int count, char** words) {
  std::string way = count > 3 ? words[1] : "";
  if (way != "hole" && way != "mesh") {
    std::fprintf(stderr, "usage: %s hole|mesh RIMS RESULT.json [factor] [runs]\n", words[0]);
    return 2;
  }
  bool hole = way == "hole";
  double factor = count > 4 ? std::stod(words[4]) : hole ? std::sqrt(2.0) : 1.4;
  int runs = count > 5 ? std::stoi(words[5]) : 15;
  std::vector<Section> sections = read_sections(words[2]);
  std::vector<Row> rows;
  for (const Section& section : sections)
    if (!hole || !is_nested(section)) {
      rows.emplace_back();
      rows.back().section = &section;
    }
  std::vector<Cover> covers(rows.size());
  // Runs of a section are apart, so that a slow minute of the machine is not all that one saw.
  for (int run = 0; run < runs; ++run)
    for (size_t i = 0; i < rows.size(); ++i) {
      double ms = 0;
      const Section& section = *rows[i].section;
      if (!(hole ? fill : mesh)(section, factor, ms, covers[i])) continue;
      rows[i].runs.push_back(ms);
    }
  std::vector<Row> done;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].runs.empty()) {
      auto& notes = rows[i].section->notes;
      std::fprintf(stderr, "not covered: %s %s %s\n", notes.at("model").c_str(), notes.at("planes").c_str(), notes.at("section").c_str());
      continue;
    }
    judge(covers[i], rows[i].section->target, rows[i]);
    done.push_back(rows[i]);
  }
  char setting[200];
  std::snprintf(setting, sizeof setting,
                hole ? "triangulate_and_refine_hole, density_control_factor %g, 2D constrained Delaunay; one loop after the other, sections without nested loops"
                     : "refine_Delaunay_mesh_2 of a constrained Delaunay triangulation, shape 0.125, size %g targets; splits rims",
                factor);
  write_results(words[3], std::string("CGAL ") + CGAL_VERSION_STR + " " + way, setting, hole, runs, done);
}
