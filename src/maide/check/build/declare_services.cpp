// Services and their ends. Their models are made by rules (rules/service_model.hpp).
#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/build/declarations.hpp"
#include "maide/check/build/open_ends.hpp"
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

// Anybody at its ends.
void declare_open_ends(Declarations& file, const TreeNode& entry, const DeclaredArray& array,
                       std::uint64_t member, Service& service) {
  const SourcePosition position = file.tree().at_name(entry);
  const TreeNode& server = *entry.find("server");
  const TreeNode& clients = *entry.find("clients");
  const bool has_client = names_anybody(file, clients);
  service.is_server_anybody = names_anybody(file, server);
  const auto check = [&](const std::string& key, bool is_there, const std::string& what) {
    const TreeNode* const field = entry.find(key);
    if (field == nullptr || is_there) return;
    file.tree().fail("'" + key + "' goes with `" + what + "`", *field);
  };
  const bool is_fair = says(entry, "fair");
  check("fair", has_client, "clients: anybody");
  check("may_not_answer", service.is_server_anybody, "server: anybody");
  if (service.is_server_anybody) {
    if (has_client) {
      file.tree().fail("one end of a service is a program or node of the file", clients);
    }
    if (service.is_depth_unknown) {
      file.tree().fail("what anybody answers has no unknown depth", *entry.find("with"));
    }
    service.server = {silent_anybody(file, position), ""};
    service.may_not_answer = says(entry, "may_not_answer");
    file.open_ends.push_back(
        service.name + ": anybody is the server; he comes at some time, stays, and answers " +
        (service.may_not_answer ? "what he likes" : "each request at last") + ", in any order");
  }
  if (!has_client) return;
  service.is_open = service.clients.empty();
  file.open_ends.push_back(
      service.name + ": anybody " + (service.is_open ? "is the client" : "is a client, too") +
      ", and asks at any time" + (is_fair ? ", again and again" : ", or never again"));
  service.anybody = static_cast<std::uint32_t>(service.clients.size());
  const std::uint32_t program = service.is_open
                                    ? silent_anybody(file, position)
                                    : busy_anybody(file, array, member, "send", {}, position);
  if (!service.is_open) file.programs[program].may_stay_away = !is_fair;
  service.clients.push_back({program, ""});
}

void declare_service(Declarations& file, const TreeNode& entry, const DeclaredArray& array,
                     std::uint64_t member) {
  const std::string name = array.member(member);
  const Indices indices = array.indices_of(member);
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
    const bool is_one = ends.size() == (names_anybody(file, *server) ? 0 : 1);
    if (!is_one) file.tree().fail("a service has one server", *server);
    if (!ends.empty()) service.server = ends.front();
  }
  if (clients != nullptr) service.clients = references.ends(*clients);
  if (const TreeNode* const learn = entry.find("learn")) model.origin = learn->text();
  if (const TreeNode* const with = entry.find("with")) read_options(file, *with, indices, service);
  if (server == nullptr) {
    file.tree().fail_at_name("service '" + name + "' needs 'server:'", entry);
  }
  if (clients == nullptr || (service.clients.empty() && !names_anybody(file, *clients))) {
    file.tree().fail_at_name("service '" + name + "' needs 'clients:'", entry);
  }
  declare_open_ends(file, entry, array, member, service);
  model.awaits_anybody = service.is_open && !says(entry, "fair");
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
      declare_service(file, entry, array, member);
    }
  }
}

}  // namespace maide
