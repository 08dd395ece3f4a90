// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "geometry/simplicial_complex.hpp"
#include "io/atomic_file.hpp"
#include "io/csv_table.hpp"
#include "io/live_message.hpp"
#include "io/mesh_file.hpp"
#include "io/network_file.hpp"
#include "io/number_table.hpp"
#include "io/pose_file.hpp"
#include "io/session_file.hpp"
#include "io/text.hpp"
#include "io/volume_file.hpp"
#include "tests/fuzz/readers.hpp"

namespace aussois {
namespace {

namespace fs = std::filesystem;

void use_mesh(const fs::path& file) {
  MeshFile mesh = read_mesh(file, 1e-3);
  weld_mesh_file(mesh);
  if (!mesh.vertices.empty()) make_complex(mesh.vertices, mesh.triangles, mesh.wires);
}

void use_volume_mesh(const fs::path& file) {
  boundary_triangles(read_volume_mesh(file, 1e-3, true).mesh);
}

void use_network(const fs::path& file) {
  const Network network = read_network(file);
  validate(network);
  write_selector(file, read_selector(file));
}

void use_poses(const fs::path& file) {
  write_poses(file, read_poses(file, 1e-3), 1e-3);
  read_poses(file, 1e-3);
}

void use_planned(const fs::path& file) {
  read_poses(file, 1e-3);
}

// A session that was not closed, closed now.
void use_journal(const fs::path& file) {
  write_session(file.parent_path() / "whole.h5", read_session(file));
  read_session(file.parent_path() / "whole.h5");
}

// A message of a page.
void use_command(const fs::path& file) {
  try {
    const LiveCommand command = live_command(read_file(file), Vec3(1, 2, 3));
    if (!command.pose.p.allFinite() || !command.twist.allFinite() || !command.grip.allFinite()) std::abort();
  } catch (const std::invalid_argument& refused) {
    throw std::runtime_error(refused.what());
  }
}

void use_numbers(const fs::path& file) {
  const NumberTable table = read_number_table(file);
  column_of(table, table.columns.front(), file);
}

// The rows that an interrupted run left.
void use_table(const fs::path& file) {
  fs::rename(file, growing_name(file));
  CsvTable table = CsvTable::resume(file, {"t", "x"}, 1);
  table.add({1, 2});
  table.close();
  read_number_table(file);
}

}  // namespace

void write_input(const fs::path& file, Bytes input) {
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(input.data()), std::streamsize(input.size()));
}

std::vector<FuzzedReader> text_readers() {
  return {{"obj", ".obj", write_input, use_mesh},         {"stl", ".stl", write_input, use_mesh},
          {"ply", ".ply", write_input, use_mesh},         {"off", ".off", write_input, use_mesh},
          {"gmsh", ".msh", write_input, use_volume_mesh}, {"medit", ".mesh", write_input, use_volume_mesh},
          {"network", ".txt", write_input, use_network},  {"poses", ".csv", write_input, use_poses},
          {"numbers", ".csv", write_input, use_numbers},  {"table", ".csv", write_input, use_table},
          {"planned", ".path", write_input, use_planned}, {"npy", ".npy", write_input, use_planned},
          {"journal", ".tmp", write_input, use_journal},  {"command", ".bin", write_input, use_command}};
}

}  // namespace aussois
