#include "maide/workflow/peer_figures.hpp"

#include <algorithm>
#include <array>

namespace maide {
namespace {

constexpr std::string_view aalpy = "AALpy", learnlib = "LearnLib";
constexpr std::string_view shahbaz = "L*M+", kv = "KV", lsharp = "L#", ttt = "TTT", adt = "ADT";

constexpr std::string_view coffee = "coffeemachine", dropbear = "DropBear", openssh = "OpenSSH",
                           mosquitto = "mosquitto__two_client_will_retain",
                           tcp = "TCP_Linux_Server", bitvise = "BitVise", m173 = "ASML_m173",
                           esm = "Mealy_3410_esm";

constexpr std::nullopt_t unknown = std::nullopt;

constexpr std::array runs{
    PeerRun{coffee, 6, 4, aalpy, shahbaz, 134, 492, 3, unknown},
    PeerRun{coffee, 6, 4, aalpy, kv, 61, 213, 5, unknown},
    PeerRun{coffee, 6, 4, aalpy, lsharp, 48, 166, 5, unknown},
    PeerRun{coffee, 6, 4, learnlib, ttt, 86, 278, 5, unknown},
    PeerRun{coffee, 6, 4, learnlib, kv, 112, 332, 5, unknown},
    PeerRun{coffee, 6, 4, learnlib, adt, 76, 247, 5, unknown},

    PeerRun{mosquitto, 18, 9, aalpy, shahbaz, 2458, 14541, 6, unknown},
    PeerRun{mosquitto, 18, 9, aalpy, kv, 477, 2483, 15, unknown},
    PeerRun{mosquitto, 18, 9, aalpy, lsharp, 391, 1995, 13, unknown},
    PeerRun{mosquitto, 18, 9, learnlib, ttt, 737, 3525, 16, unknown},
    PeerRun{mosquitto, 18, 9, learnlib, kv, 784, 3781, 15, unknown},
    PeerRun{mosquitto, 18, 9, learnlib, adt, 524, 2758, 14, unknown},

    PeerRun{dropbear, 17, 13, aalpy, shahbaz, 3078, 17961, 2, unknown},
    PeerRun{dropbear, 17, 13, aalpy, kv, 651, 3800, 12, unknown},
    PeerRun{dropbear, 17, 13, aalpy, lsharp, 557, 3265, 13, 0.29},
    PeerRun{dropbear, 17, 13, learnlib, ttt, 1118, 6174, 12, unknown},
    PeerRun{dropbear, 17, 13, learnlib, kv, 929, 5234, 12, unknown},
    PeerRun{dropbear, 17, 13, learnlib, adt, 757, 4469, 16, unknown},

    PeerRun{openssh, 31, 22, aalpy, shahbaz, 18910, 113375, 4, unknown},
    PeerRun{openssh, 31, 22, aalpy, kv, 2837, 16507, 25, unknown},
    PeerRun{openssh, 31, 22, aalpy, lsharp, 2106, 12141, 21, 6.1},
    PeerRun{openssh, 31, 22, learnlib, ttt, 3882, 21396, 25, unknown},
    PeerRun{openssh, 31, 22, learnlib, kv, 3833, 21287, 25, 0.0004},
    PeerRun{openssh, 31, 22, learnlib, adt, 1743, 10458, 21, 0.004},

    PeerRun{tcp, 57, 12, aalpy, shahbaz, 36114, 429912, 14, unknown},
    PeerRun{tcp, 57, 12, aalpy, kv, 2919, 25991, 41, unknown},
    PeerRun{tcp, 57, 12, aalpy, lsharp, 2593, 23684, 40, 8.8},
    PeerRun{tcp, 57, 12, learnlib, ttt, 4652, 40296, 40, unknown},
    PeerRun{tcp, 57, 12, learnlib, kv, 4235, 35082, 40, unknown},
    PeerRun{tcp, 57, 12, learnlib, adt, 2263, 21777, 38, 0.007},

    PeerRun{bitvise, 66, 13, aalpy, shahbaz, 22976, 226814, 13, unknown},
    PeerRun{bitvise, 66, 13, aalpy, kv, 3099, 27170, 49, unknown},
    PeerRun{bitvise, 66, 13, aalpy, lsharp, 2638, 24591, 41, 6.1},
    PeerRun{bitvise, 66, 13, learnlib, ttt, 4961, 41216, 49, unknown},
    PeerRun{bitvise, 66, 13, learnlib, kv, 4647, 38971, 49, unknown},
    PeerRun{bitvise, 66, 13, learnlib, adt, 2259, 21773, 43, 0.007},

    PeerRun{m173, 483, 27, aalpy, kv, 139'000, 1'810'000, 272, 3.4},
    PeerRun{m173, 483, 27, learnlib, ttt, 178'000, 2'250'000, 245, 0.053},
    PeerRun{m173, 483, 27, learnlib, kv, 157'000, 2'010'000, 260, 0.014},
    PeerRun{m173, 483, 27, learnlib, adt, 132'000, 1'700'000, 247, unknown},

    PeerRun{esm, 3410, 78, learnlib, ttt, 2'920'000, 62'800'000, 2177, 2.99},
    PeerRun{esm, 3410, 78, learnlib, kv, 2'470'000, 52'100'000, 2184, 0.49},
};

constexpr std::array means{
    PeerMean{aalpy, "L# ADS/ADS", 3149},         PeerMean{"L# in Rust", "L# ADS/ADS", 3355},
    PeerMean{learnlib, "ADT, cached", 3489},     PeerMean{learnlib, "TTT-lambda, cached", 3952},
    PeerMean{learnlib, "KV, cached", 4000},      PeerMean{learnlib, "OP, cached", 4022},
    PeerMean{learnlib, "TTT, cached", 4677},     PeerMean{learnlib, "L* Rivest-Schapire", 16731},
    PeerMean{learnlib, "L*M+ (Shahbaz)", 38412},
};

constexpr std::array testing{
    PeerTesting{dropbear, 17, 13, 25e3, 17}, PeerTesting{tcp, 57, 12, 0.93e6, 57},
    PeerTesting{bitvise, 66, 13, 2.3e6, 66}, PeerTesting{openssh, 31, 22, 2.3e6, 31},
    PeerTesting{esm, 3410, 78, 4.2e9, 3194},
};

constexpr std::array<std::string_view, 41> models_of_the_means{
    "10_learnresult_MasterCard_fix",
    "1_learnresult_MasterCard_fix",
    "4_learnresult_MAESTRO_fix",
    "ASN_learnresult_MAESTRO_fix",
    "ASN_learnresult_SecureCode_Aut_fix",
    "BitVise",
    "DropBear",
    "GnuTLS_3.3.12_client_full",
    "GnuTLS_3.3.12_client_regular",
    "GnuTLS_3.3.12_server_full",
    "GnuTLS_3.3.12_server_regular",
    "GnuTLS_3.3.8_client_full",
    "GnuTLS_3.3.8_client_regular",
    "GnuTLS_3.3.8_server_full",
    "GnuTLS_3.3.8_server_regular",
    "LoesTarget",
    "NSS_3.17.4_client_full",
    "NSS_3.17.4_client_regular",
    "NSS_3.17.4_server_regular",
    "OpenSSH",
    "OpenSSL_1.0.1g_client_regular",
    "OpenSSL_1.0.1g_server_regular",
    "OpenSSL_1.0.1j_client_regular",
    "OpenSSL_1.0.1j_server_regular",
    "OpenSSL_1.0.1l_server_regular",
    "OpenSSL_1.0.2_client_full",
    "OpenSSL_1.0.2_client_regular",
    "OpenSSL_1.0.2_server_regular",
    "RSA_BSAFE_C_4.0.4_server_regular",
    "RSA_BSAFE_Java_6.1.1_server_regular",
    "Rabo_learnresult_MAESTRO_fix",
    "Rabo_learnresult_SecureCode_Aut_fix",
    "TCP_FreeBSD_Client",
    "TCP_FreeBSD_Server",
    "TCP_Linux_Client",
    "TCP_Linux_Server",
    "TCP_Windows8_Client",
    "TCP_Windows8_Server",
    "Volksbank_learnresult_MAESTRO_fix",
    "learnresult_fix",
    "miTLS_0.1.3_server_regular"};

}  // namespace

std::span<const PeerRun> peer_runs() { return runs; }
std::span<const PeerMean> peer_means() { return means; }
std::span<const PeerTesting> peer_testing() { return testing; }

bool are_the_41_models(std::span<const std::string> names) {
  return std::equal(names.begin(), names.end(), models_of_the_means.begin(),
                    models_of_the_means.end());
}

}  // namespace maide
