// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/assembly/assembly_flags.hpp"

#include <cstdio>

#include "geometry/check.hpp"

namespace aussois {

void add_parts(Cli& cli, AssemblyFlags& a) {
  cli.input("--data", a.data, "folder with meshes/ and assembly/");
  cli.option("--pair", a.pair, "pair in assembly/pairs.csv");
  cli.input("--fixed", a.fixed, "mesh of the fixed part (OBJ, STL, PLY, OFF)");
  cli.input("--moving", a.moving, "mesh of the moving part");
  cli.input("--path", a.path,
            "CSV file of poses of the moving part in the frame of the fixed one: x,y,z,qw,qx,qy,qz");
  cli.option("--builtin", a.builtin, "built-in pair: bolt_nut");
  cli.option("--scale", a.scale, "length of one unit of the files", "m", kMeshScale);
  cli.option("--cache", a.scene.cache,
             "folder that keeps repaired meshes and prepared shapes for later runs, created if missing; "
             "empty: none");
}

void add_gravity(Cli& cli, AssemblyFlags& a, const std::string& note) {
  cli.option("--gravity", a.gravity, "gravity x,y,z in the fixed part's frame, m/s^2; " + note);
}

Vec3 vector_of(const std::string& text, const char* flag) {
  Vec3 v;
  char rest = 0;
  require(std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &v[0], &v[1], &v[2], &rest) == 3 && v.allFinite(),
          std::string(flag) + " = " + text + " must be three numbers x,y,z");
  return v;
}

AssemblyInput read_input(const AssemblyFlags& a) {
  const bool files = !a.fixed.empty() || !a.moving.empty() || !a.path.empty();
  require(int(files) + int(!a.pair.empty()) + int(!a.builtin.empty()) == 1,
          "give one of: --data with --pair; --fixed, --moving and --path; --builtin");
  if (!a.builtin.empty()) return builtin_assembly(a.builtin);
  if (files) {
    require(!a.fixed.empty() && !a.moving.empty() && !a.path.empty(),
            "--fixed, --moving and --path must be given together");
    return read_assembly_files(a.fixed, a.moving, a.path, a.scale, a.scene.cache);
  }
  require(!a.data.empty(), "--pair needs --data, the folder with meshes/ and assembly/");
  return read_assembly_pair(a.data, a.pair, a.scale, a.scene.cache);
}

void print_warnings(const AssemblyInput& input, const AssemblyScene& scene) {
  for (const AssemblyPart* part : {&input.fixed, &input.moving})
    for (const std::string& note : part->notes) std::fprintf(stderr, "warning: %s\n", note.c_str());
  for (const std::string& warning : scene.warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
}

}  // namespace aussois
