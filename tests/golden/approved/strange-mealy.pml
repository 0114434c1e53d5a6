/* A learned model. To use it in a system of your own, take the process type and connect
   it to your programs by two rendezvous channels. */
/* sul: sim:strange.dot */
/* versions: 1 * / - - \ 2 */
/* in_put: in put */
/* a___b: a / b */
/* x_quoted_: "quoted" */
/* zw_lf__: zwölf* / */
/* written_message: written,message */
/* mtype_2: mtype */
mtype = { in_put, a___b, class, x_quoted_, zw_lf__, quiet, written_message, mtype_2, MODULE };

proctype Model(chan InChannel; chan OutChannel) {
  goto end_s1;
end_s0:
  if
  :: InChannel?in_put -> OutChannel!quiet -> goto end_s1
  :: InChannel?a___b -> OutChannel!written_message -> goto end_s1
  :: InChannel?class -> OutChannel!mtype_2 -> goto end_s1
  :: InChannel?x_quoted_ -> OutChannel!MODULE -> goto end_s1
  :: InChannel?zw_lf__ -> OutChannel!quiet -> goto end_s1
  fi;
end_s1:
  if
  :: InChannel?in_put -> OutChannel!written_message -> goto end_s0
  :: InChannel?a___b -> OutChannel!mtype_2 -> goto end_s1
  :: InChannel?class -> OutChannel!MODULE -> goto end_s0
  :: InChannel?x_quoted_ -> OutChannel!quiet -> goto end_s1
  :: InChannel?zw_lf__ -> OutChannel!written_message -> goto end_s0
  fi;
}

proctype Environment(chan ToModel; chan FromModel) {
end:
  do
  :: ToModel!in_put
  :: ToModel!a___b
  :: ToModel!class
  :: ToModel!x_quoted_
  :: ToModel!zw_lf__
  :: FromModel?quiet
  :: FromModel?written_message
  :: FromModel?mtype_2
  :: FromModel?MODULE
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
