/* A learned model. To use it in a system of your own, take the process type and connect
   it to your programs by two rendezvous channels. */
/* bound: 1 */
/* do_2: do */
/* in_put: in-put */
/* in_put_2: in put */
/* od_2: od */
/* never_2: never */
mtype = { do_2, in_put, in_put_2, od_2, never_2 };

proctype Model(chan InChannel; chan OutChannel) {
  goto end_s2;
end_s0:
  if
  :: atomic { InChannel?do_2 -> goto end_s1 }
  :: atomic { InChannel?in_put -> goto end_s2 }
  :: atomic { InChannel?in_put_2 -> goto end_unexplored }
  fi;
end_s1:
  if
  :: OutChannel!od_2 -> goto end_s0
  :: OutChannel!do_2 -> goto end_s2
  fi;
end_s2:
  if
  :: atomic { InChannel?do_2 -> goto end_unexplored }
  :: atomic { InChannel?in_put_2 -> goto end_unexplored }
  fi;
end_unexplored:  /* never tried */
  false
}

proctype Environment(chan ToModel; chan FromModel) {
end:
  do
  :: ToModel!do_2
  :: ToModel!in_put
  :: ToModel!in_put_2
  :: FromModel?od_2
  :: FromModel?do_2
  :: FromModel?never_2
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
