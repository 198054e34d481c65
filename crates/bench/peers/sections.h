// Sections that `incise-bench refine --rims DIR` wrote, and results for `--peers`. See README.md.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

using Point2 = std::array<double, 2>;
using Corners = std::array<int, 3>;

struct Section {
  std::map<std::string, std::string> notes;
  std::vector<Point2> points;
  // A loop's first point is not repeated.
  std::vector<std::vector<int>> loops;
  double target = 0;
};

// Triangles over a section; its own points come first.
struct Cover {
  std::vector<Point2> points;
  std::vector<Corners> triangles;
};

struct Row {
  const Section* section = nullptr;
  std::vector<double> runs;
  std::vector<double> angles, edges;
  int rim_points_added = 0;
};

inline Section read_section(const std::filesystem::path& path) {
  Section section;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "#") {
      std::string name, value;
      words >> name >> value;
      section.notes[name] = value;
    } else if (key == "v") {
      Point2 p;
      words >> p[0] >> p[1];
      section.points.push_back(p);
    } else if (key == "l") {
      std::vector<int> loop;
      for (int p; words >> p;) loop.push_back(p - 1);
      loop.pop_back();
      section.loops.push_back(loop);
    }
  }
  section.target = std::stod(section.notes.at("target"));
  return section;
}

inline std::vector<Section> read_sections(const std::string& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".obj") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<Section> sections;
  for (const auto& path : paths) sections.push_back(read_section(path));
  return sections;
}

// The smallest angle of every triangle [degrees], inner edges over the target.
inline void judge(const Cover& cover, double target, Row& row) {
  std::map<std::array<int, 2>, int> sides;
  auto length = [&](int a, int b) {
    return std::hypot(cover.points[a][0] - cover.points[b][0], cover.points[a][1] - cover.points[b][1]);
  };
  for (const Corners& t : cover.triangles) {
    std::array<double, 3> l;
    for (int k = 0; k < 3; ++k) {
      int a = t[k], b = t[(k + 1) % 3];
      l[k] = length(a, b);
      ++sides[{std::min(a, b), std::max(a, b)}];
    }
    // The smallest angle lies across from the shortest side.
    std::sort(l.begin(), l.end());
    double cosine = l[1] > 0 ? (l[1] * l[1] + l[2] * l[2] - l[0] * l[0]) / (2 * l[1] * l[2]) : 1;
    row.angles.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI);
  }
  int border = 0;
  for (const auto& [side, count] : sides) {
    if (count == 2) row.edges.push_back(length(side[0], side[1]) / target);
    border += count == 1;
  }
  row.rim_points_added = border - int(row.section->points.size());
}

inline double percentile(const std::vector<double>& ordered, size_t percent) {
  return ordered[std::max<size_t>((ordered.size() * percent + 99) / 100, 1) - 1];
}

inline void write_quality(FILE* out, std::vector<double> angles, const std::vector<double>& edges) {
  std::sort(angles.begin(), angles.end());
  double sum = 0, longest = 0;
  for (double edge : edges) sum += edge, longest = std::max(longest, edge);
  std::fprintf(out,
               "\"triangles\": %zu, \"smallest_angle\": %.3f, \"angle_5\": %.3f, \"angle_median\": %.3f, "
               "\"edge_mean\": %.4f, \"edge_longest\": %.4f",
               angles.size(), angles[0], percentile(angles, 5), percentile(angles, 50),
               edges.empty() ? 0 : sum / edges.size(), longest);
}

inline void write_results(const char* path, const std::string& program, const std::string& setting, bool keeps_rims,
                          int runs, std::vector<Row>& rows) {
  FILE* out = std::fopen(path, "w");
  if (!out) std::perror(path), std::exit(1);
  std::fprintf(out, "{\n \"program\": \"%s\",\n \"setting\": \"%s\",\n \"runs\": %d,\n \"keeps_rims\": %s,\n \"models\": [",
               program.c_str(), setting.c_str(), runs, keeps_rims ? "true" : "false");
  struct Pool {
    int sections = 0;
    std::vector<double> angles, edges;
  };
  std::map<std::string, Pool> models;
  for (const Row& row : rows) {
    Pool& pool = models[row.section->notes.at("model")];
    ++pool.sections;
    pool.angles.insert(pool.angles.end(), row.angles.begin(), row.angles.end());
    pool.edges.insert(pool.edges.end(), row.edges.begin(), row.edges.end());
  }
  const char* comma = "\n";
  for (const auto& [model, pool] : models) {
    std::fprintf(out, "%s  {\"model\": \"%s\", \"sections\": %d, ", comma, model.c_str(), pool.sections);
    write_quality(out, pool.angles, pool.edges);
    std::fprintf(out, "}");
    comma = ",\n";
  }
  std::fprintf(out, "\n ],\n \"sections\": [");
  comma = "\n";
  for (Row& row : rows) {
    auto note = [&](const char* name) { return row.section->notes.at(name).c_str(); };
    std::sort(row.runs.begin(), row.runs.end());
    std::fprintf(out,
                 "%s  {\"model\": \"%s\", \"planes\": \"%s\", \"section\": %s, \"rims\": \"%s\", \"points\": %zu, "
                 "\"loops\": %zu, \"ms\": %.5f, \"ms_fastest\": %.5f, ",
                 comma, note("model"), note("planes"), note("section"), note("rims"), row.section->points.size(), row.section->loops.size(),
                 row.runs[(row.runs.size() - 1) / 2], row.runs[0]);
    write_quality(out, row.angles, row.edges);
    std::fprintf(out, ", \"rim_points_added\": %d}", row.rim_points_added);
    comma = ",\n";
  }
  std::fprintf(out, "\n ]\n}\n");
  std::fclose(out);
}
