/* A learned model. To use it in a system of your own, take the process type and connect
   it to your programs by two rendezvous channels. */
mtype = { write, read, message };

proctype Model(chan InChannel; chan OutChannel) {
end_s0:
  if
  :: atomic { InChannel?write -> goto end_s2 }
  :: atomic { InChannel?read -> goto end_s1 }
  fi;
end_s1:
  if
  :: atomic { InChannel?write -> goto end_s3 }
  fi;
end_s2:
  if
  :: atomic { InChannel?read -> goto end_s3 }
  :: atomic { InChannel?write -> goto end_unexplored }
  fi;
end_s3:
  if
  :: OutChannel!message -> goto end_s0
  fi;
end_unexplored:  /* never tried */
  false
}

proctype Environment(chan ToModel; chan FromModel) {
end:
  do
  :: ToModel!write
  :: ToModel!read
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
