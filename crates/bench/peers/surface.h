// Reads the vertices and triangles of an OBJ file, and times steps.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

struct Surface {
    std::vector<float> positions;  // [m], shape [vertices, 3]
    std::vector<int> triangles;    // shape [triangles, 3]
};

inline Surface read_surface(const char *path) {
    std::ifstream file(path);
    Surface surface;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string kind, word;
        words >> kind;
        for (int k = 0; k < 3 && words >> word; k++) {
            if (kind == "v") surface.positions.push_back(std::strtof(word.c_str(), nullptr));
            if (kind == "f") surface.triangles.push_back(std::atoi(word.c_str()) - 1);
        }
    }
    return surface;
}

// Returns the time of the fastest of 200 steps [ms].
template <class Step>
double fastest(Step step) {
    double best = 1e9;
    for (int i = 0; i < 200; i++) {
        auto start = std::chrono::steady_clock::now();
        step();
        std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
        best = std::min(best, time.count());
    }
    return best;
}
