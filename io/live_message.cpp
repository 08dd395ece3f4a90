// SPDX-License-Identifier: Apache-2.0
#include "io/live_message.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "geometry/check.hpp"
#include "geometry/digest.hpp"

namespace aussois {
namespace {

static_assert(std::endian::native == std::endian::little, "messages are copied as they lie");

constexpr double kFar = 1e3, kFast = 1e2, kSpin = 1e3;  // [m], [m/s], [rad/s]
constexpr std::size_t kCommandBytes = 120, kFrameBytes = 128, kMeshBytes = 64;

class ByteWriter {
 public:
  template <class T>
  ByteWriter& put(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  ByteWriter& put(const Vec3& v) { return put(float(v.x())).put(float(v.y())).put(float(v.z())); }
  ByteWriter& head(LiveKind kind, std::size_t bytes, std::uint64_t sequence) {
    bytes_.reserve(bytes);
    return put(std::uint16_t(kind)).put(kLiveVersion).put(std::uint32_t(bytes)).put(sequence);
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_{};
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  T get() {
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  double number(const char* what, double bound) {
    const auto value = get<double>();
    require_field(std::abs(value) <= bound, what, value, ("lie within " + number_text(bound)).c_str());
    return value;
  }
  Vec3 vector(const char* what, double bound) {
    const double x = number(what, bound), y = number(what, bound), z = number(what, bound);
    return {x, y, z};
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

}  // namespace

std::string to_bytes(const LiveFrame& f, const Vec3& origin, std::uint64_t sequence, std::uint64_t skipped) {
  const std::size_t bytes = kFrameBytes + 28 * f.meshes.size() + 44 * f.contacts.size();
  ByteWriter out;
  out.head(LiveKind::frame, bytes, sequence).put(f.t).put(f.moment).put(f.take).put(f.flags);
  out.put(float(f.slow)).put(float(f.distance)).put(Vec3(f.near_a - origin)).put(Vec3(f.near_b - origin));
  out.put(f.pull).put(f.torque).put(std::uint32_t(f.meshes.size())).put(std::uint32_t(f.contacts.size()));
  out.put(f.all_contacts).put(std::uint32_t(0)).put(skipped).put(f.ends);
  for (const SE3& g : f.meshes) {
    out.put(Vec3(g.p - origin));
    for (const double q : {g.R.x(), g.R.y(), g.R.z(), g.R.w()}) out.put(float(q));
  }
  for (const LiveContact& c : f.contacts)
    out.put(Vec3(c.point - origin))
        .put(c.normal)
        .put(c.force)
        .put(float(c.gap))
        .put(std::uint16_t(c.a))
        .put(std::uint16_t(c.b));
  return out.take();
}

std::string to_bytes(const LiveMesh& mesh) {
  ByteWriter out;
  const std::size_t bytes =
      kMeshBytes + 12 * mesh.vertices.size() + 12 * mesh.faces.size() + 8 * mesh.wires.size();
  out.head(LiveKind::mesh, bytes, 0).put(mesh.hash).put(std::uint32_t(mesh.vertices.size()));
  out.put(std::uint32_t(mesh.faces.size())).put(std::uint32_t(mesh.wires.size()));
  for (int spare = 0; spare < 7; ++spare) out.put(std::uint32_t(0));
  for (const Vec3& v : mesh.vertices) out.put(v);
  for (const auto& face : mesh.faces)
    for (const int i : face) out.put(std::uint32_t(i));
  for (const auto& wire : mesh.wires)
    for (const int i : wire) out.put(std::uint32_t(i));
  return out.take();
}

std::string to_bytes(const LiveCommand& c, const Vec3& origin, std::uint64_t sequence) {
  ByteWriter out;
  out.head(LiveKind::command, kCommandBytes, sequence).put(std::uint32_t(c.mode)).put(std::uint32_t(c.firm));
  out.put(c.drawn);
  if (c.mode == LiveCommand::Mode::twist) {
    for (const double v : c.twist) out.put(v);
    out.put(0.0);
  } else {
    for (const double x : Vec3(c.pose.p - origin)) out.put(x);
    for (const double q : {c.pose.R.x(), c.pose.R.y(), c.pose.R.z(), c.pose.R.w()}) out.put(q);
  }
  for (const double x : c.grip) out.put(x);
  return out.put(std::uint64_t(0)).take();
}

LiveCommand live_command(std::string_view bytes, const Vec3& origin) {
  require_field(bytes.size() == kCommandBytes, "message: bytes", bytes.size(), "be 120 of a command");
  ByteReader in(bytes);
  const auto kind = in.get<std::uint16_t>(), version = in.get<std::uint16_t>();
  require_field(kind == std::uint16_t(LiveKind::command), "message: kind", kind, "be 2, a command");
  require_field(version == kLiveVersion, "message: version", version, "be 1");
  const auto length = in.get<std::uint32_t>();
  require_field(length == kCommandBytes, "message: length in its head", length, "be that of the message");
  (void)in.get<std::uint64_t>();
  LiveCommand out;
  const auto mode = in.get<std::uint32_t>(), firm = in.get<std::uint32_t>();
  require_field(mode <= 2, "command: mode", mode, "be 0, 1 or 2");
  require_field(firm <= 1, "command: firm", firm, "be 0 or 1");
  out.mode = LiveCommand::Mode(mode);
  out.firm = firm == 1;
  out.drawn = in.get<std::uint64_t>();
  if (out.mode == LiveCommand::Mode::twist) {
    out.twist.head<3>() = in.vector("command: speed [m/s]", kFast);
    out.twist.tail<3>() = in.vector("command: spin [rad/s]", kSpin);
    (void)in.get<double>();
  } else {
    out.pose.p = origin + in.vector("command: target [m]", kFar);
    const double x = in.number("command: quaternion", 2), y = in.number("command: quaternion", 2),
                 z = in.number("command: quaternion", 2), w = in.number("command: quaternion", 2);
    out.pose.R = {w, x, y, z};
    if (out.mode == LiveCommand::Mode::pose) out.pose = checked_pose(out.pose, "command: pose");
  }
  out.grip = in.vector("command: grip [m]", kFar);
  return out;
}

std::uint64_t content_hash(const LiveMesh& mesh) {
  Digest digest;
  for (const Vec3& v : mesh.vertices)
    for (const double x : v) digest.add(x);
  digest.add(std::uint64_t(mesh.faces.size()));
  for (const auto& face : mesh.faces)
    for (const int i : face) digest.add(std::uint64_t(i));
  for (const auto& wire : mesh.wires)
    for (const int i : wire) digest.add(std::uint64_t(i));
  return digest.value;
}

}  // namespace aussois
