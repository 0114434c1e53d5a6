// Services and their ends. Their models are made by rules (rules/service_model.hpp).
#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/build/declarations.hpp"
#include "maide/check/build/references.hpp"

namespace maide {
namespace {

constexpr std::uint32_t max_depth = 1000;

void read_options(Declarations& file, const TreeNode& with, const Indices& indices,
                  Service& service) {
  if (const TreeNode* const rmw = with.find("rmw")) {
    service.takes_one_by_one = rmw->is("fastrtps");
    service.rmw = rmw->text();
  }
  const TreeNode* const depth = with.find("depth");
  if (depth == nullptr) return;
  if (!depth->number) {
    service.is_depth_unknown = true;
    service.depth = 1;
    return;
  }
  service.depth = count_of(constant_of(file, *depth->number, indices), max_depth);
  if (service.depth == 0) {
    file.tree().fail("'depth' goes from 1 to " + std::to_string(max_depth), *depth);
  }
}

void declare_service(Declarations& file, const TreeNode& entry, const std::string& name,
                     const Indices& indices) {
  Service service;
  service.name = name;
  ModelInstance model;
  model.name = name;
  model.source = ModelInstance::Source::service;
  model.position = file.tree().at_name(entry);
  const References references(file, indices);
  const TreeNode* const server = entry.find("server");
  const TreeNode* const clients = entry.find("clients");
  if (server != nullptr) {
    const std::vector<End> ends = references.ends(*server);
    if (ends.size() != 1) file.tree().fail("a service has one server", *server);
    service.server = ends.front();
  }
  if (clients != nullptr) service.clients = references.ends(*clients);
  if (const TreeNode* const learn = entry.find("learn")) model.origin = learn->text();
  if (const TreeNode* const with = entry.find("with")) read_options(file, *with, indices, service);
  if (server == nullptr) {
    file.tree().fail_at_name("service '" + name + "' needs 'server:'", entry);
  }
  if (service.clients.empty()) {
    file.tree().fail_at_name("service '" + name + "' needs 'clients:'", entry);
  }
  file.deliveries.emplace(static_cast<std::uint32_t>(file.models.size()),
                          read_delivery(file, entry, {}));
  file.names.services.emplace(static_cast<std::uint32_t>(file.models.size()), std::move(service));
  file.models.push_back(std::move(model));
  file.origins.emplace_back();
}

}  // namespace

void declare_services(Declarations& file) {
  for (const TreeNode& entry : file.tree().entries("services")) {
    const DeclaredArray array = declare_array(file, entry);
    if (file.models.size() + array.count() > max_components) {
      file.tree().fail_at_name("too many services", entry);
    }
    const ModelName name{
        static_cast<std::uint32_t>(file.models.size()), array.dimensions, false, {}};
    file.names.models.emplace(array.name, name);
    file.service_arrays.emplace(array.name, name);
    for (std::uint64_t member = 0; member < array.count(); ++member) {
      declare_service(file, entry, array.member(member), array.indices_of(member));
    }
  }
}

}  // namespace maide
