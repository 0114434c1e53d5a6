// Writing a wrapper: a separate program through which Maide asks a middleware, a driver, a robot.
// It links maide::wrapper alone, which has no learner in it.
//
// A wrapper says what the system is, makes fresh instances of it, and makes the real calls:
//
//   class Mailbox : public maide::SystemWrapper {
//    public:
//     const maide::WrapperDescription& description() const override;    // name, options
//     maide::SystemSetup configure(const maide::OptionValues&) override;  // actors, inputs, events
//     std::unique_ptr<maide::SystemInstance> reset(maide::EventSink&) override;  // a fresh one
//   };
//   int main(int argc, char** argv) {
//     Mailbox wrapper;
//     return maide::run_wrapper(wrapper, argc, argv);
//   }
//
// docs/writing-a-wrapper.md has all of it. The SDK does the rest. Every actor has a thread of its
// own, so calls may block. Events are collected until the system is quiescent. Words, decision
// trees and the protocol (docs/protocol.md) are played.
//
// States of a wrapper. description() may be called at any time and must start nothing, because a
// listening wrapper forks for each client after it. configure() is called once, before the first
// reset(). At most one instance lives at a time. call() runs on the actor's thread. shutdown() runs
// on another thread, while calls may be blocked; after it every call must return soon. An EventSink
// may be told by any thread, from reset() until the instance is destroyed.
//
// Errors: configure() throws UsageError for options that do not go together. Any exception from
// reset() or call() ends the word with an error that names the wrapper, and the next word begins
// anew. A wrapper that crashes or hangs is ended and started again, and the word's answer says so.
//
// Cost: a step takes as long as the system needs to come to rest, and some 0.1 ms besides.
#pragma once

#include "maide/base/error.hpp"
#include "maide/wire/client/child_process.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "maide/wire/wrapper/wrapper_options.hpp"
