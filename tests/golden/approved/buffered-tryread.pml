/* A learned model. To use it in a system of your own, take the process type and connect
   it to your programs by two rendezvous channels. */
mtype = { write, read, tryread, message };

proctype Model(chan InChannel; chan OutChannel) {
end_s0:
  if
  :: atomic { InChannel?write -> goto end_s1 }
  :: atomic { InChannel?read -> goto end_s2 }
  :: atomic { InChannel?tryread -> goto end_s0 }
  fi;
end_s1:
  if
  :: atomic { InChannel?write -> goto end_s1 }
  :: atomic { InChannel?read -> goto end_s3 }
  :: atomic { InChannel?tryread -> goto end_s3 }
  fi;
end_s2:
  if
  :: atomic { InChannel?write -> goto end_s3 }
  fi;
end_s3:
  if
  :: OutChannel!message -> goto end_s0
  fi;
}

proctype Environment(chan ToModel; chan FromModel) {
end:
  do
  :: ToModel!write
  :: ToModel!read
  :: ToModel!tryread
  :: FromModel?message
  od
}

chan ToTheModel = [0] of { mtype };
chan FromTheModel = [0] of { mtype };

init {
  atomic {
    run Model(ToTheModel, FromTheModel);
    run Environment(ToTheModel, FromTheModel)
  }
}
