// Prints what libsdformat, Gazebo's own reader, makes of a URDF or SDF file, as one JSON object a model.
//
//   g++ -std=c++17 -O1 read_values.cc -o read_values $(pkg-config --cflags --libs sdformat12)
//   ./read_values FILE [FOLDER_OF_MODELS...]
//
// All poses are resolved: x, y, z and the quaternion w, x, y, z. Links, frames and joints are in the model's frame,
// axes too; collisions and sensors are in their link's; models are in the world's or the outer model's. What cannot be
// resolved is null.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <sdf/sdf.hh>

using ignition::math::Pose3d;

static std::string Text(const std::string &_text) {
  std::string out = "\"";
  for (char c : _text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out + "\"";
}

static std::string Number(double _value) {
  if (std::isnan(_value)) return "null";
  if (std::isinf(_value)) return _value > 0 ? "1e400" : "-1e400";
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", _value);
  return text;
}

static std::string Numbers(const std::vector<double> &_values) {
  std::string out = "[";
  for (std::size_t i = 0; i < _values.size(); ++i) out += (i ? "," : "") + Number(_values[i]);
  return out + "]";
}

static std::string Pose(const Pose3d &_pose) {
  const auto &p = _pose.Pos();
  const auto &q = _pose.Rot();
  return Numbers({p.X(), p.Y(), p.Z(), q.W(), q.X(), q.Y(), q.Z()});
}

static std::string Resolved(const sdf::SemanticPose &_pose, const std::string &_in) {
  Pose3d pose;
  const auto errors = _pose.Resolve(pose, _in);
  for (const auto &error : errors) std::cerr << error.Message() << "\n";
  return errors.empty() ? Pose(pose) : "null";
}

template <class F> static std::string List(std::size_t _count, F _item) {
  std::string out = "[";
  for (std::size_t i = 0; i < _count; ++i) out += (i ? "," : "") + _item(i);
  return out + "]";
}

static std::string Sensor(const sdf::Sensor &_sensor) {
  return "{\"name\":" + Text(_sensor.Name()) + ",\"type\":" + Text(_sensor.TypeStr()) + ",\"topic\":" +
         Text(_sensor.Topic()) + ",\"rate\":" + Number(_sensor.UpdateRate()) + ",\"pose\":" +
         Resolved(_sensor.SemanticPose(), "") + "}";
}

static std::string Collision(const sdf::Collision &_collision) {
  double mu = 1.0, mu2 = 1.0;
  ignition::math::Vector3d fdir1;
  sdf::ElementPtr element = _collision.Element();
  for (const char *tag : {"surface", "friction", "ode"})
    element = element && element->HasElement(tag) ? element->GetElement(tag) : nullptr;
  if (element) {
    mu = element->Get<double>("mu");
    mu2 = element->Get<double>("mu2");
    fdir1 = element->Get<ignition::math::Vector3d>("fdir1");
  }
  const auto *geometry = _collision.Geom();
  const bool isMesh = geometry && geometry->Type() == sdf::GeometryType::MESH;
  const bool isPlane = geometry && geometry->Type() == sdf::GeometryType::PLANE;
  return "{\"name\":" + Text(_collision.Name()) + ",\"is_other\":" + (isMesh || isPlane ? "true" : "false") +
         ",\"pose\":" + Resolved(_collision.SemanticPose(), "") + ",\"mu\":" + Number(mu) + ",\"mu2\":" + Number(mu2) + ",\"fdir1\":" +
         Numbers({fdir1.X(), fdir1.Y(), fdir1.Z()}) + "}";
}

static std::string Link(const sdf::Link &_link) {
  const auto sensors = [&](std::size_t i) { return Sensor(*_link.SensorByIndex(i)); };
  const auto collisions = [&](std::size_t i) { return Collision(*_link.CollisionByIndex(i)); };
  const auto &element = _link.Element();
  const bool selfCollide = element && element->HasElement("self_collide") && element->Get<bool>("self_collide");
  return "{\"name\":" + Text(_link.Name()) + ",\"pose\":" + Resolved(_link.SemanticPose(), "__model__") +
         ",\"mass\":" + Number(_link.Inertial().MassMatrix().Mass()) + ",\"self_collide\":" +
         (selfCollide ? "true" : "false") + ",\"collisions\":" + List(_link.CollisionCount(), collisions) +
         ",\"sensors\":" + List(_link.SensorCount(), sensors) + "}";
}

static const char *const kTypes[] = {"ball", "continuous", "fixed", "gearbox", "prismatic", "revolute", "revolute2",
                                     "screw", "universal"};

static std::string Joint(const sdf::Joint &_joint) {
  std::string parent = _joint.ParentLinkName(), child = _joint.ChildLinkName();
  _joint.ResolveParentLink(parent);
  _joint.ResolveChildLink(child);
  const int type = static_cast<int>(_joint.Type()) - static_cast<int>(sdf::JointType::BALL);
  std::string out = "{\"name\":" + Text(_joint.Name()) + ",\"type\":" +
                    Text(type >= 0 && type < 9 ? kTypes[type] : "unknown") + ",\"parent\":" + Text(parent) +
                    ",\"child\":" + Text(child) + ",\"pose\":" +
                    Resolved(_joint.SemanticPose(), "__model__");
  if (const auto *axis = _joint.Axis(0)) {
    ignition::math::Vector3d xyz;
    axis->ResolveXyz(xyz, "__model__");
    out += ",\"axis\":" + Numbers({xyz.X(), xyz.Y(), xyz.Z()}) + ",\"limits\":" +
           Numbers({axis->Lower(), axis->Upper(), axis->MaxVelocity(), axis->Effort()}) + ",\"damping\":" +
           Number(axis->Damping()) + ",\"friction\":" + Number(axis->Friction());
  }
  const auto sensors = [&](std::size_t i) { return Sensor(*_joint.SensorByIndex(i)); };
  return out + ",\"sensors\":" + List(_joint.SensorCount(), sensors) + "}";
}

static std::string Frame(const sdf::Frame &_frame) {
  return "{\"name\":" + Text(_frame.Name()) + ",\"pose\":" + Resolved(_frame.SemanticPose(), "__model__") + "}";
}

static std::string Model(const sdf::Model &_model, const std::string &_in) {
  const auto links = [&](std::size_t i) { return Link(*_model.LinkByIndex(i)); };
  const auto joints = [&](std::size_t i) { return Joint(*_model.JointByIndex(i)); };
  const auto frames = [&](std::size_t i) { return Frame(*_model.FrameByIndex(i)); };
  const auto models = [&](std::size_t i) { return Model(*_model.ModelByIndex(i), "__model__"); };
  return "{\"name\":" + Text(_model.Name()) + ",\"static\":" + (_model.Static() ? "true" : "false") + ",\"pose\":" +
         Resolved(_model.SemanticPose(), _in) + ",\"links\":" + List(_model.LinkCount(), links) +
         ",\"joints\":" + List(_model.JointCount(), joints) + ",\"frames\":" + List(_model.FrameCount(), frames) +
         ",\"models\":" + List(_model.ModelCount(), models) + "}";
}

int main(int _argc, char **_argv) {
  if (_argc < 2) return 2;
  sdf::ParserConfig config;
  config.SetFindCallback([&](const std::string &_uri) -> std::string {
    std::string path = _uri;
    for (const char *prefix : {"model://", "package://", "file://"})
      if (path.rfind(prefix, 0) == 0) path = path.substr(std::string(prefix).size());
    for (int i = 2; i < _argc; ++i) {
      const std::string found = std::string(_argv[i]) + "/" + path;
      if (std::ifstream(found).good()) return found;
    }
    return std::ifstream(path).good() ? path : "";
  });
  sdf::Root root;
  const auto errors = root.Load(_argv[1], config);
  for (const auto &error : errors) std::cerr << error.Message() << "\n";
  if (const auto *model = root.Model()) {
    std::cout << Model(*model, "") << "\n";
  } else if (root.WorldCount()) {
    const auto *world = root.WorldByIndex(0);
    for (std::size_t i = 0; i < world->ModelCount(); ++i)
      std::cout << Model(*world->ModelByIndex(i), "world") << "\n";
  } else {
    return 1;
  }
  return 0;
}
