#include "maide/wire/local_sul.hpp"

#include <stdexcept>

#include "maide/base/error.hpp"

namespace maide {

LocalSul::LocalSul(SystemWrapper& wrapper, const std::map<std::string, std::string>& options)
    : session_(wrapper) {
  session_.configure(options);
}

void LocalSul::run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
                   const RunControl& control) {
  for (std::size_t index = 0; index < batch.size(); ++index) {
    control.check("running words on the system");
    SulAnswer answer;
    try {
      answer = session_.run(batch[index], [&] { return control.should_stop(); });
    } catch (const Error&) {
      throw;
    } catch (const std::exception& error) {
      throw WrapperError(error.what(), session_.info().name + " in this process");
    }
    if (answer.end == WordEnd::aborted) control.check("running words on the system");
    sink(index, std::move(answer));
  }
}

}  // namespace maide
